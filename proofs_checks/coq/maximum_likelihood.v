(* T6(i): the probability that some law of a finite class at overlap at most b with the truth is as likely as the
   truth on n independent draws is at most (number of such laws) * b^n, whatever breaks ties. *)
Require Import Reals List Lra.
Require Import Bridge.finite_sums.
Import ListNotations.
Open Scope R_scope.

Section Samples.
Context {A : Type} (points : list A).

Fixpoint samples (n : nat) : list (list A) :=
  match n with
  | O => [[]]
  | S k => flat_map (fun x => map (cons x) (samples k)) points
  end.

Fixpoint likelihood (g : A -> R) (sample : list A) : R :=
  match sample with
  | [] => 1
  | x :: rest => g x * likelihood g rest
  end.

Definition overlap (p g : A -> R) : R := sum (fun x => sqrt (p x * g x)) points.

Lemma likelihood_nonneg g sample : (forall x, 0 <= g x) -> 0 <= likelihood g sample.
Proof. intros H. induction sample; simpl; [lra|]. apply Rmult_le_pos; auto. Qed.

Lemma overlap_of_samples p g n :
  (forall x, 0 <= p x) -> (forall x, 0 <= g x) ->
  sum (fun s => sqrt (likelihood p s * likelihood g s)) (samples n) = overlap p g ^ n.
Proof.
  intros Hp Hg. induction n as [|n IH]; simpl.
  - replace (1 * 1) with 1 by ring. rewrite sqrt_1. lra.
  - rewrite sum_flat_map.
    transitivity (sum (fun x => overlap p g ^ n * sqrt (p x * g x)) points).
    + apply sum_ext. intros x _. rewrite sum_map. rewrite <- IH, Rmult_comm, <- sum_scal.
      apply sum_ext. intros s _. simpl.
      replace (p x * likelihood p s * (g x * likelihood g s))
        with ((p x * g x) * (likelihood p s * likelihood g s)) by ring.
      apply sqrt_mult; apply Rmult_le_pos; auto; apply likelihood_nonneg; auto.
    + rewrite sum_scal. fold (overlap p g). ring.
Qed.

Definition beats (p g : A -> R) (s : list A) : R :=
  if Rle_dec (likelihood p s) (likelihood g s) then 1 else 0.

(* The probability under p that g is at least as likely as p. *)
Definition failure (p g : A -> R) (n : nat) : R := sum (fun s => likelihood p s * beats p g s) (samples n).

Lemma pairwise p g n : (forall x, 0 <= p x) -> (forall x, 0 <= g x) -> failure p g n <= overlap p g ^ n.
Proof.
  intros Hp Hg. rewrite <- overlap_of_samples by auto. apply sum_le. intros s _.
  pose proof (likelihood_nonneg p s Hp). pose proof (likelihood_nonneg g s Hg).
  unfold beats. destruct (Rle_dec (likelihood p s) (likelihood g s)).
  - rewrite Rmult_1_r. rewrite <- (sqrt_square (likelihood p s)) at 1 by auto.
    apply sqrt_le_1; nra.
  - rewrite Rmult_0_r. apply sqrt_pos.
Qed.

Definition some_beats (p : A -> R) (class : list (A -> R)) (s : list A) : R :=
  if Exists_dec (fun g => likelihood p s <= likelihood g s) class
      (fun g => Rle_dec (likelihood p s) (likelihood g s))
  then 1 else 0.

Lemma union_bound p class s : some_beats p class s <= sum (fun g => beats p g s) class.
Proof.
  unfold some_beats. destruct (Exists_dec _ _ _) as [E|E].
  - induction E as [g class H|g class _ IH]; simpl.
    + assert (0 <= sum (fun h => beats p h s) class).
      { apply sum_nonneg. intros h _. unfold beats. destruct (Rle_dec _ _); lra. }
      unfold beats at 1. destruct (Rle_dec _ _); [lra|contradiction].
    + assert (0 <= beats p g s) by (unfold beats; destruct (Rle_dec _ _); lra). lra.
  - apply sum_nonneg. intros h _. unfold beats. destruct (Rle_dec _ _); lra.
Qed.

Theorem finite_class p class b n :
  (forall x, 0 <= p x) ->
  (forall g, In g class -> (forall x, 0 <= g x) /\ 0 <= overlap p g <= b) ->
  sum (fun s => likelihood p s * some_beats p class s) (samples n) <= INR (length class) * b ^ n.
Proof.
  intros Hp Hclass.
  apply Rle_trans with (sum (fun g => failure p g n) class).
  - unfold failure. rewrite sum_swap. apply sum_le. intros s _. rewrite sum_scal.
    apply Rmult_le_compat_l; [apply likelihood_nonneg; auto|apply union_bound].
  - induction class as [|g class IH].
    + simpl. lra.
    + change (length (g :: class)) with (S (length class)). rewrite S_INR. simpl sum.
      destruct (Hclass g) as [Hg [Hlow Hb]]; [simpl; auto|].
      assert (failure p g n <= b ^ n).
      { eapply Rle_trans; [apply pairwise; auto|apply pow_incr; auto]. }
      assert (sum (fun g => failure p g n) class <= INR (length class) * b ^ n).
      { apply IH. intros; apply Hclass; simpl; auto. }
      lra.
Qed.

End Samples.
