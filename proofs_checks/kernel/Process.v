(* A process: a law of the next outcome given the past, on a finite list of outcomes.

   A history lists the outcomes, the latest first. Sessions, trajectories and data sets are processes. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums.
Import ListNotations.
Open Scope R_scope.

Record process (X : Type) := Process {
  outcomes : list X;
  step : list X -> X -> R;
  step_nonneg : forall h x, 0 <= step h x;
  step_total : forall h, sum (step h) outcomes = 1
}.
Arguments Process {X}. Arguments outcomes {X}. Arguments step {X}.
Arguments step_nonneg {X}. Arguments step_total {X}.

(* Does a property hold now and at every earlier time? *)
Fixpoint always {X : Type} (A : list X -> Prop) (h : list X) : Prop :=
  A h /\ match h with [] => True | _ :: past => always A past end.

Fixpoint ever {X : Type} (b : list X -> bool) (h : list X) : bool :=
  b h || match h with [] => false | _ :: past => ever b past end.

(* All histories of n outcomes. *)
Fixpoint histories {X : Type} (points : list X) (n : nat) : list (list X) :=
  match n with
  | O => [[]]
  | S k => flat_map (fun h => map (fun x => x :: h) points) (histories points k)
  end.

Lemma histories_length_list {X : Type} (points : list X) n h : In h (histories points n) -> length h = n.
Proof.
  revert h. induction n as [|n IH]; simpl; intros h I.
  - destruct I as [<-|[]]; reflexivity.
  - apply in_flat_map in I. destruct I as [p [I J]]. apply in_map_iff in J. destruct J as [x [<- _]].
    simpl. rewrite (IH p I). reflexivity.
Qed.

Lemma always_now {X} (A : list X -> Prop) h : always A h -> A h.
Proof. destruct h; simpl; tauto. Qed.

Lemma always_impl {X} (A B : list X -> Prop) : (forall h, A h -> B h) -> forall h, always A h -> always B h.
Proof. intros Q. induction h as [|x h IH]; simpl; intuition. Qed.

Section Process.
Context {X : Type} (P : process X).

(* The probability of a history. *)
Fixpoint prob (h : list X) : R :=
  match h with
  | [] => 1
  | x :: past => prob past * step P past x
  end.

Definition expect (n : nat) (f : list X -> R) : R := sum (fun h => prob h * f h) (histories (outcomes P) n).
Definition Pr (n : nat) (b : list X -> bool) : R := expect n (fun h => indicator (b h)).

(* With probability at least c, A: an event of that probability on which A holds, impossible histories apart. *)
Definition with_probability (c : R) (n : nat) (A : list X -> Prop) : Prop :=
  exists b : list X -> bool, c <= Pr n b
    /\ forall h, In h (histories (outcomes P) n) -> 0 < prob h -> b h = true -> A h.

Lemma prob_nonneg h : 0 <= prob h.
Proof. induction h; simpl; [lra|]. apply Rmult_le_pos; auto. apply step_nonneg. Qed.

Lemma histories_length n h : In h (histories (outcomes P) n) -> length h = n.
Proof. apply histories_length_list. Qed.

Lemma histories_outcomes n h x : In h (histories (outcomes P) n) -> In x h -> In x (outcomes P).
Proof.
  revert h. induction n as [|n IH]; simpl; intros h I J.
  - destruct I as [<-|[]]. destruct J.
  - apply in_flat_map in I. destruct I as [p [I K]]. apply in_map_iff in K. destruct K as [y [<- K]].
    destruct J as [<-|J]; auto. apply (IH p); auto.
Qed.

Lemma histories_cons n x h : In (x :: h) (histories (outcomes P) (S n)) <-> In x (outcomes P) /\
  In h (histories (outcomes P) n).
Proof.
  simpl. rewrite in_flat_map. split.
  - intros [p [I J]]. apply in_map_iff in J. destruct J as [y [E J]]. inversion E; subst. auto.
  - intros [I J]. exists h. split; auto. apply in_map_iff. exists x. auto.
Qed.

Lemma histories_all n h : (forall x, In x h -> In x (outcomes P)) -> length h = n -> In h (histories (outcomes P) n).
Proof.
  revert n. induction h as [|x h IH]; intros n Q L; simpl in L; subst n; [simpl; auto|].
  apply histories_cons. split; [apply Q; simpl; auto|]. apply IH; auto. intros; apply Q; simpl; auto.
Qed.

Lemma expect_zero f : expect 0 f = f [].
Proof. unfold expect; simpl; lra. Qed.

Lemma expect_step n f :
  expect (S n) f = expect n (fun h => sum (fun x => step P h x * f (x :: h)) (outcomes P)).
Proof.
  unfold expect. simpl. rewrite sum_flat_map. apply sum_ext. intros h _. rewrite sum_map.
  rewrite <- sum_scal. apply sum_ext. intros x _. simpl. ring.
Qed.

Lemma expect_ext n f g : (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> f h = g h) ->
  expect n f = expect n g.
Proof.
  intros Q. apply sum_ext. intros h I. destruct (Rle_lt_or_eq_dec 0 (prob h) (prob_nonneg h)) as [L|E].
  - rewrite (Q h); auto.
  - rewrite <- E; ring.
Qed.

Lemma expect_le n f g : (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> f h <= g h) ->
  expect n f <= expect n g.
Proof.
  intros Q. apply sum_le. intros h I. destruct (Rle_lt_or_eq_dec 0 (prob h) (prob_nonneg h)) as [L|E].
  - apply Rmult_le_compat_l; auto. lra.
  - rewrite <- E; lra.
Qed.

Lemma expect_plus n f g : expect n (fun h => f h + g h) = expect n f + expect n g.
Proof. unfold expect. rewrite <- sum_plus. apply sum_ext. intros; ring. Qed.

Lemma expect_scal n c f : expect n (fun h => c * f h) = c * expect n f.
Proof. unfold expect. rewrite <- sum_scal. apply sum_ext. intros; ring. Qed.

Lemma expect_const n c : expect n (fun _ => c) = c.
Proof.
  induction n as [|n IH]; [apply expect_zero|]. rewrite expect_step. transitivity (expect n (fun _ => c));
    [|exact IH].
  apply expect_ext. intros h _ _. rewrite sum_scal_r, step_total. ring.
Qed.

Lemma prob_total n : sum prob (histories (outcomes P) n) = 1.
Proof. rewrite <- (expect_const n 1). apply sum_ext. intros; ring. Qed.

Lemma expect_nonneg n f : (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> 0 <= f h) -> 0 <= expect n f.
Proof. intros Q. rewrite <- (expect_const n 0). apply expect_le; auto. Qed.

Lemma expect_sum {B} n (f : B -> list X -> R) (l : list B) :
  expect n (fun h => sum (fun b => f b h) l) = sum (fun b => expect n (f b)) l.
Proof.
  unfold expect. rewrite sum_swap. apply sum_ext. intros h _. symmetry; apply sum_scal.
Qed.

Lemma Pr_range n b : 0 <= Pr n b <= 1.
Proof.
  split.
  - apply expect_nonneg. intros; apply indicator_range.
  - rewrite <- (expect_const n 1). apply expect_le. intros; apply indicator_range.
Qed.

Lemma Pr_le n a b :
  (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> a h = true -> b h = true) -> Pr n a <= Pr n b.
Proof.
  intros Q. apply expect_le. intros h I L. specialize (Q h I L).
  destruct (a h); [rewrite Q; auto; lra|apply indicator_range].
Qed.

Lemma Pr_not n b : Pr n (fun h => negb (b h)) = 1 - Pr n b.
Proof.
  assert (Pr n (fun h => negb (b h)) + Pr n b = 1); [|lra].
  unfold Pr. rewrite <- expect_plus, <- (expect_const n 1). apply expect_ext.
  intros h _ _. destruct (b h); simpl; ring.
Qed.

Lemma Pr_union {B} n (e : B -> list X -> bool) (l : list B) :
  Pr n (fun h => existsb (fun b => e b h) l) <= sum (fun b => Pr n (e b)) l.
Proof.
  unfold Pr. rewrite <- expect_sum. apply expect_le. intros h _ _.
  induction l as [|b l IH]; simpl; [lra|]. pose proof (indicator_range (e b h)).
  destruct (e b h); simpl in *; [|lra].
  assert (0 <= sum (fun b => indicator (e b h)) l) by (apply sum_nonneg; intros; apply indicator_range). lra.
Qed.

(* Markov's inequality. *)
Lemma markov_inequality n c f :
  (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> 0 <= f h) ->
  c * Pr n (fun h => if Rle_dec c (f h) then true else false) <= expect n f.
Proof.
  intros Q. unfold Pr. rewrite <- expect_scal. apply expect_le. intros h I L.
  specialize (Q h I L). destruct (Rle_dec c (f h)); simpl; lra.
Qed.

Lemma with_probability_weaken c c' n A :
  c' <= c -> with_probability c n A -> with_probability c' n A.
Proof. intros L [b [Q B]]. exists b. split; auto. lra. Qed.

Lemma with_probability_impl c n (A B : list X -> Prop) :
  (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> A h -> B h) -> with_probability c n A ->
    with_probability c n B.
Proof. intros Q [b [L E]]. exists b. split; auto. Qed.

(* Two events at once. *)
Lemma with_probability_and d e n (A B : list X -> Prop) :
  with_probability (1 - d) n A -> with_probability (1 - e) n B ->
  with_probability (1 - d - e) n (fun h => A h /\ B h).
Proof.
  intros [a [La Qa]] [b [Lb Qb]]. exists (fun h => a h && b h). split.
  - assert (Pr n a + Pr n b <= 1 + Pr n (fun h => a h && b h)); [|lra].
    unfold Pr. rewrite <- expect_plus. rewrite <- (expect_const n 1), <- expect_plus. apply expect_le.
      intros h _ _. destruct (a h), (b h); simpl; lra.
  - intros h I L E. apply andb_prop in E. destruct E. split; auto.
Qed.

Lemma surely n (A : list X -> Prop) :
  (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> A h) -> with_probability 1 n A.
Proof.
  intros Q. exists (fun _ => true). split; auto. unfold Pr; simpl. rewrite expect_const. lra.
Qed.

(* Where the failure of A has probability at most d. *)
Lemma with_probability_not d n (b : list X -> bool) (A : list X -> Prop) :
  Pr n b <= d -> (forall h, In h (histories (outcomes P) n) -> 0 < prob h -> b h = false -> A h) ->
    with_probability (1 - d) n A.
Proof.
  intros L Q. exists (fun h => negb (b h)). split; [rewrite Pr_not; lra|].
  intros h I J E. apply Q; auto. destruct (b h); auto; discriminate.
Qed.

(* Ville's inequality: a nonnegative supermartingale from at most 1 stays below 1/delta with probability 1 - delta. *)
Section Ville.
Variables (M : list X -> R) (delta : R).
Hypothesis M_nonneg : forall h, 0 <= M h.
Hypothesis M_start : M [] <= 1.
Hypothesis M_falls : forall h, sum (fun x => step P h x * M (x :: h)) (outcomes P) <= M h.
Hypothesis delta_pos : 0 < delta.

Let large h := if Rle_dec 1 (delta * M h) then true else false.

(* The process stopped where it first is large. *)
Fixpoint stopped (h : list X) : R :=
  match h with
  | [] => M []
  | _ :: past => if ever large past then stopped past else M h
  end.

Lemma stopped_before h : ever large h = false -> stopped h = M h.
Proof.
  destruct h as [|x h]; simpl; auto. intros E. apply orb_false_elim in E. destruct E as [_ E].
  rewrite E. reflexivity.
Qed.

Lemma stopped_nonneg h : 0 <= stopped h.
Proof. induction h as [|x h IH]; cbn [stopped]; auto. destruct (ever large h); auto. Qed.

Lemma stopped_large h : ever large h = true -> 1 <= delta * stopped h.
Proof.
  induction h as [|x h IH].
  - cbn [ever stopped]. rewrite orb_false_r. unfold large. destruct (Rle_dec _ _); [auto|discriminate].
  - cbn [ever stopped]. intros E. destruct (ever large h) eqn:F; auto.
    rewrite orb_false_r in E. unfold large in E. destruct (Rle_dec _ _); [auto|discriminate].
Qed.

Lemma stopped_falls n : expect n stopped <= 1.
Proof.
  induction n as [|n IH]; [rewrite expect_zero; simpl; auto|].
  rewrite expect_step. eapply Rle_trans; [|exact IH]. apply expect_le. intros h _ _. cbn [stopped].
  destruct (ever large h) eqn:E.
  - rewrite sum_scal_r, step_total. lra.
  - rewrite (stopped_before h E). apply M_falls.
Qed.

Theorem ville n : with_probability (1 - delta) n (always (fun h => delta * M h < 1)).
Proof.
  apply with_probability_not with (b := ever large).
  - apply Rmult_le_reg_l with (/ delta); [apply Rinv_0_lt_compat; auto|].
    rewrite Rinv_l by lra. eapply Rle_trans; [|apply (stopped_falls n)].
    unfold Pr. rewrite <- expect_scal. apply expect_le. intros h _ _.
    pose proof (stopped_nonneg h). destruct (ever large h) eqn:E; simpl; [|lra].
    pose proof (stopped_large h E). apply Rmult_le_reg_l with delta; auto.
    rewrite <- Rmult_assoc, Rinv_r by lra. lra.
  - intros h _ _. induction h as [|x h IH]; cbn [ever always]; intros E; apply orb_false_elim in E;
      destruct E as [E F]; split; auto; unfold large in E; destruct (Rle_dec _ _); try discriminate; lra.
Qed.

End Ville.
End Process.

Arguments with_probability {X}. Arguments Pr {X}. Arguments expect {X}. Arguments prob {X}.

(* Independent draws from one law. *)
Section Independent.
Context {X : Type} (points : list X) (p : X -> R).
Hypothesis p_nonneg : forall x, 0 <= p x.
Hypothesis p_total : sum p points = 1.

Definition independent : process X := Process points (fun _ => p) (fun _ => p_nonneg) (fun _ => p_total).

Lemma prob_independent h : prob independent h = product p h.
Proof. induction h as [|x h IH]; simpl; auto. rewrite IH. ring. Qed.

(* The expectation of a product is the product of expectations. *)
Lemma expect_product n (f : X -> R) :
  expect independent n (product f) = sum (fun x => p x * f x) points ^ n.
Proof.
  induction n as [|n IH]; [apply expect_zero|]. rewrite expect_step.
  rewrite (expect_ext _ n _ (fun h => sum (fun x => p x * f x) points * product f h)).
  - rewrite expect_scal, IH. reflexivity.
  - intros h _ _. simpl. rewrite <- sum_scal_r. apply sum_ext. intros; ring.
Qed.

(* The probability that every draw is good. *)
Lemma Pr_forall n (good : X -> bool) :
  Pr independent n (forallb good) = sum (fun x => p x * indicator (good x)) points ^ n.
Proof.
  rewrite <- expect_product. apply expect_ext. intros h _ _.
  induction h as [|x h IH]; simpl; auto. rewrite <- IH. destruct (good x); simpl; ring.
Qed.

End Independent.

(* One choice for each element of a list: what the axiom of choice says of finitely many. *)
Lemma finite_choice {A B : Type} (same : forall x y : A, {x = y} + {x <> y}) (other : B) (l : list A)
  (Q : A -> B -> Prop) :
  (forall x, In x l -> exists y, Q x y) -> exists f : A -> B, forall x, In x l -> Q x (f x).
Proof.
  induction l as [|x l IH]; intros E; [exists (fun _ => other); intros ? []|].
  destruct IH as [f F]; [intros; apply E; simpl; auto|]. destruct (E x) as [y Y]; [simpl; auto|].
  exists (fun z => if same z x then y else f z). intros z [<-|I].
  - destruct (same x x); congruence.
  - destruct (same z x); [subst; auto|auto].
Qed.

(* A second process whose law depends on what the first one gave: sessions after demonstrations. *)
Section Stages.
Context {X Y : Type} (P : process X) (Q : list X -> process Y) (n m : nat).

Definition Pr_both (b : list X -> list Y -> bool) : R := expect P n (fun d => Pr (Q d) m (b d)).

Definition with_probability_both (c : R) (A : list X -> list Y -> Prop) : Prop :=
  exists b : list X -> list Y -> bool, c <= Pr_both b
    /\ forall d h, In d (histories (outcomes P) n) -> In h (histories (outcomes (Q d)) m) ->
         0 < prob P d -> 0 < prob (Q d) h -> b d h = true -> A d h.

Theorem in_two_stages (same : forall x y : list X, {x = y} + {x <> y}) d e
  (A : list X -> Prop) (B : list X -> list Y -> Prop) : 0 <= d -> 0 <= e <= 1 ->
  with_probability P (1 - d) n A ->
  (forall D, In D (histories (outcomes P) n) -> 0 < prob P D -> A D -> with_probability (Q D) (1 - e) m (B D)) ->
  with_probability_both (1 - d - e) B.
Proof.
  intros Pd Pe [a [La Qa]] W.
  destruct (finite_choice same (fun _ => false) (histories (outcomes P) n)
    (fun D b => 0 < prob P D -> a D = true -> 1 - e <= Pr (Q D) m b
       /\ forall h, In h (histories (outcomes (Q D)) m) -> 0 < prob (Q D) h -> b h = true -> B D h)) as [b E].
  { intros D I. destruct (Rlt_dec 0 (prob P D)) as [L|L]; [|exists (fun _ => false); intros; contradiction].
    destruct (a D) eqn:F; [|exists (fun _ => false); intros; discriminate].
    destruct (W D I L (Qa D I L F)) as [b Eb]. exists b. auto. }
  exists (fun D h => a D && b D h). split.
  - unfold Pr_both.
    assert ((1 - e) * Pr P n a <= expect P n (fun d0 => Pr (Q d0) m (fun h => a d0 && b d0 h))).
    { unfold Pr at 1. rewrite <- expect_scal. apply expect_le. intros D I L. destruct (a D) eqn:F; simpl.
      - destruct (E D I L F) as [G _]. unfold Pr in *. lra.
      - rewrite Rmult_0_r. apply Pr_range. }
    pose proof (Pr_range P n a). nra.
  - intros D h I J L K F. apply andb_prop in F. destruct F as [F G].
    destruct (E D I L F) as [_ T]. apply T; auto.
Qed.

End Stages.
