(* Finite models given by tables of rationals, evaluated by computation: for refutations.

   A quantity is a sum of terms c sqrt(q), as a list of pairs (c, q) of rationals. *)
Require Import Reals QArith Qreals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Distances Bridge.Claims.
Import ListNotations.
Open Scope R_scope.

(* Sums of terms c sqrt(q) *)

Definition surds := list (Q * Q).
Definition value (l : surds) : R := sum (fun m => Q2R (fst m) * sqrt (Q2R (snd m))) l.

Lemma value_cons c q l : value ((c, q) :: l) = Q2R c * sqrt (Q2R q) + value l.
Proof. reflexivity. Qed.

Lemma value_app l m : value (l ++ m) = value l + value m.
Proof. apply sum_app. Qed.

Lemma Q2R_of_red q : Q2R (Qred q) = Q2R q.
Proof. apply Qeq_eqR, Qred_correct. Qed.

Lemma Q2R_zero : Q2R 0 = 0.
Proof. unfold Q2R; simpl; lra. Qed.

Lemma Q2R_one : Q2R 1 = 1.
Proof. unfold Q2R; simpl; lra. Qed.

Lemma Q2R_of_nat (n : nat) : Q2R (inject_Z (Z.of_nat n)) = INR n.
Proof. unfold Q2R; simpl. rewrite INR_IZR_INZ. field. Qed.

Definition rational (q : Q) : surds := [(q, 1%Q)].

Lemma value_rational q : value (rational q) = Q2R q.
Proof. unfold value; simpl. rewrite Q2R_one, sqrt_1. ring. Qed.

(* One term, with an exact root where there is one. *)
Definition root (q : Q) : surds :=
  if Qeq_bool q 0 then []
  else let r := Qmake (Z.sqrt (Qnum q)) (Pos.sqrt (Qden q)) in
    if Qeq_bool (r * r) q then [(r, 1%Q)] else [(1%Q, q)].

Lemma value_root q : value (root q) = sqrt (Q2R q).
Proof.
  unfold root. destruct (Qeq_bool q 0) eqn:Z.
  - apply Qeq_bool_eq, Qeq_eqR in Z. rewrite Z, Q2R_zero, sqrt_0. reflexivity.
  - cbv zeta. set (r := Qmake _ _). destruct (Qeq_bool (r * r) q) eqn:E.
    + apply Qeq_bool_eq, Qeq_eqR in E. rewrite Q2R_mult in E. rewrite <- E, sqrt_square.
      * unfold value; simpl. rewrite Q2R_one, sqrt_1. ring.
      * rewrite <- Q2R_zero. apply Qle_Rle. unfold Qle; simpl. pose proof (Z.sqrt_nonneg (Qnum q)). lia.
    + unfold value; simpl. rewrite Q2R_one. ring.
Qed.

Definition scale (c : Q) (l : surds) : surds :=
  if Qeq_bool c 0 then [] else map (fun m => (Qred (c * fst m), snd m)) l.

Lemma value_scale c l : value (scale c l) = Q2R c * value l.
Proof.
  unfold scale. destruct (Qeq_bool c 0) eqn:Z.
  - apply Qeq_bool_eq, Qeq_eqR in Z. rewrite Z, Q2R_zero. unfold value; simpl. ring.
  - clear Z. unfold value. rewrite sum_map, <- sum_scal. apply sum_ext. intros m _.
    cbn [fst snd]. rewrite Q2R_of_red, Q2R_mult. ring.
Qed.

Definition negated (l : surds) : surds := scale (-1) l.

Lemma value_negated l : value (negated l) = - value l.
Proof. unfold negated. rewrite value_scale. unfold Q2R; simpl. lra. Qed.

Definition surds_of {X : Type} (f : X -> surds) (l : list X) : surds := flat_map f l.

Lemma value_surds_of {X : Type} (f : X -> surds) g l :
  (forall x, value (f x) = g x) -> value (surds_of f l) = sum g l.
Proof. intros Q. induction l as [|x l IH]; [reflexivity|]. simpl. rewrite value_app, Q, <- IH. reflexivity. Qed.

Fixpoint sum_q {X : Type} (f : X -> Q) (l : list X) : Q :=
  match l with [] => 0%Q | x :: l => Qred (f x + sum_q f l) end.

Lemma sum_q_is {X : Type} (f : X -> Q) g l : (forall x, Q2R (f x) = g x) -> Q2R (sum_q f l) = sum g l.
Proof.
  intros F. induction l as [|x l IH]; cbn [sum_q sum]; [apply Q2R_zero|]. rewrite Q2R_of_red, Q2R_plus, F, IH. reflexivity.
Qed.

(* Laws with rational entries *)

Record table (X : finite) := Table {
  entry : X -> Q;
  entries_nonneg : forallb (fun x => Qle_bool 0 (entry x)) (elements X) = true;
  entries_total : Qeq_bool (sum_q entry (elements X)) 1 = true
}.
Arguments Table {X}. Arguments entry {X}. Arguments entries_nonneg {X}. Arguments entries_total {X}.

Definition table_law {X : finite} (p : table X) : law X.
Proof.
  refine (Law X (fun x => Q2R (entry p x)) _ _).
  - intros x. rewrite <- Q2R_zero. apply Qle_Rle, Qle_bool_iff.
    pose proof (entries_nonneg p) as N. rewrite forallb_forall in N. apply N, complete.
  - rewrite <- (sum_q_is (entry p)) by reflexivity. rewrite <- Q2R_one. apply Qeq_eqR, Qeq_bool_eq, entries_total.
Defined.

Lemma table_law_is {X : finite} (p : table X) x : table_law p x = Q2R (entry p x).
Proof. reflexivity. Qed.

Section Models.
Context {St Ac : finite}.
Notation history := (list (St * Ac)).

(* The numbers of a process with a stationary kernel, and those of policies. *)
Definition next (start : table St) (kernel : St -> Ac -> table St) (h : history) : St -> Q :=
  match h with [] => entry start | (s, a) :: _ => entry (kernel s a) end.

Definition table_markov (start : table St) (kernel : St -> Ac -> table St) : environment St Ac :=
  markov (table_law start) (fun s a => table_law (kernel s a)).

Lemma next_is start kernel h s : table_markov start kernel h s = Q2R (next start kernel h s).
Proof. destruct h as [|[s' a'] h]; reflexivity. Qed.

Definition certain (f : St -> Ac) (h : history) (s : St) (a : Ac) : Q := if eqb a (f s) then 1%Q else 0%Q.

Lemma certain_is f h s a : deterministic f h s a = Q2R (certain f h s a).
Proof.
  unfold certain. cbn. unfold dirac_mass. destruct (eqb a (f s)); cbn [indicator]; [rewrite Q2R_one|rewrite Q2R_zero]; reflexivity.
Qed.

Definition chosen (choice : history -> St -> table Ac) (h : history) (s : St) (a : Ac) : Q := entry (choice h s) a.
Definition table_policy (choice : history -> St -> table Ac) : policy St Ac := fun h s => table_law (choice h s).

Lemma chosen_is choice h s a : table_policy choice h s a = Q2R (chosen choice h s a).
Proof. reflexivity. Qed.

Section Evaluated.
Context (E : environment St Ac) (pi : policy St Ac) (e : history -> St -> Q) (c : history -> St -> Ac -> Q).
Hypothesis E_is : forall h s, E h s = Q2R (e h s).
Hypothesis pi_is : forall h s a, pi h s a = Q2R (c h s a).

Fixpoint probability (h : history) : Q :=
  match h with
  | [] => 1%Q
  | (s, a) :: past =>
      let before := probability past in
      if Qeq_bool before 0 then 0%Q else Qred (before * (e past s * c past s a))
  end.

Lemma probability_is h : trajectory_law E pi h = Q2R (probability h).
Proof.
  unfold trajectory_law. induction h as [|[s a] past IH]; [symmetry; apply Q2R_one|].
  cbn [prob probability]. rewrite IH. cbv zeta. destruct (Qeq_bool (probability past) 0) eqn:Z.
  - apply Qeq_bool_eq, Qeq_eqR in Z. rewrite Z, Q2R_zero. ring.
  - rewrite Q2R_of_red, !Q2R_mult, <- E_is, <- pi_is. reflexivity.
Qed.

Definition arrival (t : history * St) : Q :=
  let before := probability (fst t) in
  if Qeq_bool before 0 then 0%Q else Qred (before * e (fst t) (snd t)).

Lemma arrival_is t : arrival_law E pi t = Q2R (arrival t).
Proof.
  unfold arrival_law, arrival. rewrite probability_is. cbv zeta.
  destruct (Qeq_bool (probability (fst t)) 0) eqn:Z.
  - apply Qeq_bool_eq, Qeq_eqR in Z. rewrite Z, Q2R_zero. ring.
  - rewrite Q2R_of_red, Q2R_mult, <- E_is. reflexivity.
Qed.

Definition visitation (t : nat) (s : St) (a : Ac) : Q :=
  sum_q (fun h => match h with [] => 0%Q | m :: _ => if eqb (m : pairs St Ac) (s, a) then probability h else 0%Q end)
    (histories (elements (pairs St Ac)) (S t)).

Lemma visitation_is t s a : pair_occupancy E pi t s a = Q2R (visitation t s a).
Proof.
  unfold pair_occupancy, Pr, expect, visitation. symmetry. apply sum_q_is. intros [|m h].
  - rewrite Q2R_zero. simpl. ring.
  - destruct (eqb (m : pairs St Ac) (s, a)); cbn [indicator].
    + rewrite <- probability_is. unfold trajectory_law. ring.
    + rewrite Q2R_zero. ring.
Qed.

Definition mean_q (H : nat) (f : history -> Q) : Q :=
  sum_q (fun h => (probability h * f h)%Q) (histories (elements (pairs St Ac)) H).

Lemma mean_is H f g : (forall h, g h = Q2R (f h)) -> mean E pi H g = Q2R (mean_q H f).
Proof.
  intros F. unfold mean, expect, mean_q. symmetry. apply sum_q_is. intros h.
  rewrite Q2R_mult, F, <- probability_is. reflexivity.
Qed.

End Evaluated.
End Models.

(* Distances of laws with rational masses *)

Definition hellinger2_surds {X : Type} (l : list X) (a b : X -> Q) : surds :=
  rational 1 ++ negated (surds_of (fun x => root (Qred (a x * b x))) l).

Lemma hellinger2_is {X : Type} (l : list X) p q a b :
  (forall x, p x = Q2R (a x)) -> (forall x, q x = Q2R (b x)) -> hellinger2 l p q = value (hellinger2_surds l a b).
Proof.
  intros P Q. unfold hellinger2, hellinger2_surds. rewrite value_app, value_negated, value_rational, Q2R_one.
  unfold Rminus. f_equal. f_equal. unfold overlap. symmetry. apply value_surds_of. intros x.
  rewrite value_root, Q2R_of_red, Q2R_mult, P, Q. reflexivity.
Qed.
