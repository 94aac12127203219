(* The quantities of the refuted claims for models given by tables: equal to lists of rationals that Coq computes. *)
Require Import Reals QArith Qreals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Distances Bridge.Tables Bridge.Claims.
Import ListNotations.
Open Scope R_scope.

Section Evaluation.
Context {St Ac : finite} (start : table St) (P Phat : St -> Ac -> table St).
Notation law_of kernel := (fun s a => table_law (kernel s a)).
Notation choices := (list (St * Ac) -> St -> Ac -> Q).

Lemma trajectory_error_is (pi : policy St Ac) (c : choices) H : (forall h s a, pi h s a = Q2R (c h s a)) ->
  trajectory_error (table_law start) (law_of P) (law_of Phat) pi H
    = value (hellinger2_surds (arrivals H) (arrival (next start Phat) c) (arrival (next start P) c)).
Proof. intros Q. apply hellinger2_is; intros t; apply arrival_is; auto; apply next_is. Qed.

Lemma policy_error_is (pi pi' : policy St Ac) (c c' : choices) H :
  (forall h s a, pi h s a = Q2R (c h s a)) -> (forall h s a, pi' h s a = Q2R (c' h s a)) ->
  policy_error (table_law start) (law_of P) pi pi' H
    = value (hellinger2_surds (arrivals H) (arrival (next start P) c) (arrival (next start P) c')).
Proof. intros Q Q'. apply hellinger2_is; intros t; apply arrival_is; auto; apply next_is. Qed.

Lemma policy_distance_is (pi pi' : policy St Ac) (c c' : choices) H :
  (forall h s a, pi h s a = Q2R (c h s a)) -> (forall h s a, pi' h s a = Q2R (c' h s a)) ->
  hellinger2 (trajectories H) (trajectory_law (markov (table_law start) (law_of P)) pi)
    (trajectory_law (markov (table_law start) (law_of P)) pi')
    = value (hellinger2_surds (trajectories H) (probability (next start P) c) (probability (next start P) c')).
Proof. intros Q Q'. apply hellinger2_is; intros t; apply probability_is; auto; apply next_is. Qed.

Definition row_surds (s : St) (a : Ac) : surds := hellinger2_surds (elements St) (entry (P s a)) (entry (Phat s a)).

Lemma row_surds_is s a : value (row_surds s a) = row_error (law_of P) (law_of Phat) s a.
Proof. symmetry. apply hellinger2_is; reflexivity. Qed.

Definition overlap_surds (s : St) (a : Ac) : surds :=
  surds_of (fun x => root (Qred (entry (P s a) x * entry (Phat s a) x))) (elements St).

Lemma overlap_surds_is s a :
  value (overlap_surds s a) = overlap (elements St) (table_law (P s a)) (table_law (Phat s a)).
Proof.
  unfold overlap. apply value_surds_of. intros x. rewrite value_root, Q2R_of_red, Q2R_mult. reflexivity.
Qed.

Definition expected_surds (c : choices) (t : nat) (f : St -> Ac -> surds) : surds :=
  surds_of (fun m => scale (visitation (next start P) c t (fst m) (snd m)) (f (fst m) (snd m)))
    (elements (pairs St Ac)).

Lemma expected_is (pi : policy St Ac) (c : choices) t f g :
  (forall h s a, pi h s a = Q2R (c h s a)) -> (forall s a, value (f s a) = g s a) ->
  expected (table_law start) (law_of P) pi t g = value (expected_surds c t f).
Proof.
  intros Q F. symmetry. apply value_surds_of. intros m. rewrite value_scale, F. f_equal.
  symmetry. apply visitation_is; auto. apply next_is.
Qed.

Lemma expected_sum_is (pi : policy St Ac) (c : choices) l f g :
  (forall h s a, pi h s a = Q2R (c h s a)) -> (forall s a, value (f s a) = g s a) ->
  sum (fun t => expected (table_law start) (law_of P) pi t g) l = value (surds_of (fun t => expected_surds c t f) l).
Proof. intros Q F. symmetry. apply value_surds_of. intros t. symmetry. apply expected_is; auto. Qed.

(* Is a statement about every step and pair true of the visitations? *)
Definition everywhere (expert other : choices) (H : nat) (b : Q -> Q -> bool) : bool :=
  forallb (fun t => forallb (fun m => b (visitation (next start P) expert t (fst m) (snd m))
    (visitation (next start P) other t (fst m) (snd m))) (elements (pairs St Ac))) (seq 0 H).

Lemma everywhere_is expert other H b : everywhere expert other H b = true -> forall t s a, (t < H)%nat ->
  b (visitation (next start P) expert t s a) (visitation (next start P) other t s a) = true.
Proof.
  unfold everywhere. rewrite forallb_forall. intros Q t s a L.
  specialize (Q t ltac:(apply in_seq; lia)). rewrite forallb_forall in Q. apply (Q (s, a)). apply (complete (pairs St Ac)).
Qed.

Lemma concentrability_is (expert pi : policy St Ac) (c c' : choices) H (C : Q) :
  (forall h s a, expert h s a = Q2R (c h s a)) -> (forall h s a, pi h s a = Q2R (c' h s a)) ->
  everywhere c c' H (fun p q => Qle_bool p 0 || Qle_bool q (C * p))%bool = true ->
  concentrability (table_law start) (law_of P) expert pi H (Q2R C).
Proof.
  intros Q Q' B t s a L O. pose proof (everywhere_is c c' H _ B t s a L) as W. cbv beta in W.
  fold (table_markov start P) in *.
  rewrite (visitation_is _ _ _ _ (next_is start P) Q) in O |- *.
  rewrite (visitation_is _ _ _ _ (next_is start P) Q').
  apply orb_prop in W. destruct W as [W|W]; apply Qle_bool_iff, Qle_Rle in W.
  - rewrite Q2R_zero in W. lra.
  - rewrite Q2R_mult in W. exact W.
Qed.

Lemma full_support_is (expert pi : policy St Ac) (c c' : choices) H :
  (forall h s a, expert h s a = Q2R (c h s a)) -> (forall h s a, pi h s a = Q2R (c' h s a)) ->
  everywhere c c' H (fun p q => Qle_bool q 0 || negb (Qle_bool p 0))%bool = true ->
  full_support (table_law start) (law_of P) expert pi H.
Proof.
  intros Q Q' B t s a L O. pose proof (everywhere_is c c' H _ B t s a L) as W. cbv beta in W.
  fold (table_markov start P) in *.
  rewrite (visitation_is _ _ _ _ (next_is start P) Q') in O.
  rewrite (visitation_is _ _ _ _ (next_is start P) Q).
  apply orb_prop in W. destruct W as [W|W].
  - apply Qle_bool_iff, Qle_Rle in W. rewrite Q2R_zero in W. lra.
  - destruct (Qlt_le_dec 0 (visitation (next start P) c t s a)) as [G|G].
    + apply Qlt_Rlt in G. rewrite Q2R_zero in G. exact G.
    + apply Qle_bool_iff in G. rewrite G in W. discriminate.
Qed.

Lemma visited_is (pi : policy St Ac) (c : choices) H (gamma : Q) :
  (forall h s a, pi h s a = Q2R (c h s a)) ->
  everywhere c c H (fun p _ => Qle_bool p 0 || Qle_bool gamma p)%bool = true ->
  forall t s a, (t < H)%nat -> 0 < pair_occupancy (markov (table_law start) (law_of P)) pi t s a ->
    Q2R gamma <= pair_occupancy (markov (table_law start) (law_of P)) pi t s a.
Proof.
  intros Q B t s a L O. pose proof (everywhere_is c c H _ B t s a L) as W. cbv beta in W.
  fold (table_markov start P) in *.
  rewrite (visitation_is _ _ _ _ (next_is start P) Q) in O |- *.
  apply orb_prop in W. destruct W as [W|W]; apply Qle_bool_iff, Qle_Rle in W; [|exact W].
  rewrite Q2R_zero in W. lra.
Qed.

End Evaluation.

(* Replace every list by its value. *)
Ltac compute_surds claim :=
  repeat match type of claim with
  | context [value ?l] =>
      let computed := eval vm_compute in l in
      first [constr_eq l computed; fail 1
            | let same := fresh in assert (same : l = computed) by (vm_compute; reflexivity);
              rewrite same in claim; clear same; let known := fresh in
              set (known := value computed) in claim]
  end.

Ltac write_out claim :=
  compute_surds claim;
  repeat match goal with known := value _ |- _ => unfold known in claim; clear known end;
  cbv [value sum map app fst snd Q2R Qnum Qden INR] in claim.
