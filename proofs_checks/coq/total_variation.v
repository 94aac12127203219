(* H^2 <= TV and TV^2 <= H^2 (2 - H^2) for finite laws p, q on the points of a list. *)
Require Import Reals List Lra.
Require Import Bridge.finite_sums.
Import ListNotations.
Open Scope R_scope.

Section Laws.
Context {A : Type} (p q : A -> R) (l : list A).
Hypothesis p_nonneg : forall x, In x l -> 0 <= p x.
Hypothesis q_nonneg : forall x, In x l -> 0 <= q x.
Hypothesis p_total : sum p l = 1.
Hypothesis q_total : sum q l = 1.

Definition overlap : R := sum (fun x => sqrt (p x * q x)) l.
Definition squared_hellinger : R := 1 - overlap.
Definition total_variation : R := / 2 * sum (fun x => Rabs (p x - q x)) l.

Let minus x := Rabs (sqrt (p x) - sqrt (q x)).
Let plus x := sqrt (p x) + sqrt (q x).

Lemma gap_factors : sum (fun x => Rabs (p x - q x)) l = sum (fun x => minus x * plus x) l.
Proof.
  apply sum_ext. intros x Hx. unfold minus, plus.
  pose proof (sqrt_pos (p x)). pose proof (sqrt_pos (q x)).
  rewrite <- (Rabs_pos_eq (sqrt (p x) + sqrt (q x))) by lra.
  rewrite <- Rabs_mult. f_equal.
  replace ((sqrt (p x) - sqrt (q x)) * (sqrt (p x) + sqrt (q x)))
    with (sqrt (p x) * sqrt (p x) - sqrt (q x) * sqrt (q x)) by ring.
  rewrite !sqrt_sqrt; auto.
Qed.

Lemma squares_minus : sum (fun x => minus x * minus x) l = 2 - 2 * overlap.
Proof.
  replace (2 - 2 * overlap) with (sum p l + sum q l + (-2) * overlap) by lra.
  unfold overlap. rewrite <- sum_scal, <- !sum_plus.
  apply sum_ext. intros x Hx. unfold minus.
  rewrite <- Rabs_mult, Rabs_pos_eq by apply Rle_0_sqr.
  rewrite sqrt_mult by auto.
  rewrite <- (sqrt_sqrt (p x)) at 3 by auto. rewrite <- (sqrt_sqrt (q x)) at 3 by auto. ring.
Qed.

Lemma squares_plus : sum (fun x => plus x * plus x) l = 2 + 2 * overlap.
Proof.
  replace (2 + 2 * overlap) with (sum p l + sum q l + 2 * overlap) by lra.
  unfold overlap. rewrite <- sum_scal, <- !sum_plus.
  apply sum_ext. intros x Hx. unfold plus.
  rewrite sqrt_mult by auto.
  rewrite <- (sqrt_sqrt (p x)) at 3 by auto. rewrite <- (sqrt_sqrt (q x)) at 3 by auto. ring.
Qed.

Theorem total_variation_by_hellinger :
  total_variation * total_variation <= squared_hellinger * (2 - squared_hellinger).
Proof.
  unfold total_variation, squared_hellinger.
  rewrite gap_factors.
  pose proof (cauchy_schwarz minus plus l) as CS.
  rewrite squares_minus, squares_plus in CS. nra.
Qed.

Theorem hellinger_below_total_variation : squared_hellinger <= total_variation.
Proof.
  assert (sum (fun x => p x + q x + (-1) * Rabs (p x - q x)) l <= 2 * overlap) as H.
  { unfold overlap. rewrite <- sum_scal. apply sum_le. intros x Hx.
    pose proof (p_nonneg x Hx). pose proof (q_nonneg x Hx).
    assert (Rmin (p x) (q x) <= sqrt (p x * q x)) as M.
    { unfold Rmin. destruct (Rle_dec (p x) (q x)).
      - rewrite <- (sqrt_square (p x)) at 1 by auto. apply sqrt_le_1; nra.
      - rewrite <- (sqrt_square (q x)) at 1 by auto. apply sqrt_le_1; nra. }
    unfold Rmin, Rabs in *. destruct (Rle_dec (p x) (q x)); destruct (Rcase_abs (p x - q x)); lra. }
  rewrite !sum_plus, sum_scal, p_total, q_total in H.
  unfold squared_hellinger, total_variation. lra.
Qed.

End Laws.
