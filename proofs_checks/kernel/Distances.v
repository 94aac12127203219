(* Hellinger distance, total variation and Kullback-Leibler divergence of two laws on a list of points. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums.
Import ListNotations.
Open Scope R_scope.

Section Distances.
Context {X : Type} (l : list X).

Definition overlap (p q : X -> R) : R := sum (fun x => sqrt (p x * q x)) l.
Definition hellinger2 (p q : X -> R) : R := 1 - overlap p q.
Definition hellinger (p q : X -> R) : R := sqrt (hellinger2 p q).
Definition total_variation (p q : X -> R) : R := / 2 * sum (fun x => Rabs (p x - q x)) l.

Lemma overlap_sym p q : overlap p q = overlap q p.
Proof. apply sum_ext. intros. rewrite Rmult_comm. reflexivity. Qed.

Lemma overlap_nonneg p q : 0 <= overlap p q.
Proof. apply sum_nonneg. intros. apply sqrt_pos. Qed.

Lemma hellinger2_sym p q : hellinger2 p q = hellinger2 q p.
Proof. unfold hellinger2. rewrite overlap_sym. reflexivity. Qed.

Lemma total_variation_sym p q : total_variation p q = total_variation q p.
Proof. unfold total_variation. f_equal. apply sum_ext. intros. apply Rabs_minus_sym. Qed.

Section Laws.
Context (p q : X -> R).
Hypothesis p_nonneg : forall x, 0 <= p x.
Hypothesis q_nonneg : forall x, 0 <= q x.
Hypothesis p_total : sum p l = 1.
Hypothesis q_total : sum q l = 1.

(* Half the squared distance of the roots. *)
Lemma hellinger2_roots :
  hellinger2 p q = / 2 * sum (fun x => (sqrt (p x) - sqrt (q x)) * (sqrt (p x) - sqrt (q x))) l.
Proof.
  unfold hellinger2, overlap.
  replace (sum (fun x => (sqrt (p x) - sqrt (q x)) * (sqrt (p x) - sqrt (q x))) l)
    with (sum p l + sum q l + (-2) * sum (fun x => sqrt (p x * q x)) l); [lra|].
  rewrite <- sum_scal, <- !sum_plus. apply sum_ext. intros x _. rewrite root_mult by auto.
  rewrite <- (sqrt_sqrt (p x)) at 1 by auto. rewrite <- (sqrt_sqrt (q x)) at 1 by auto. ring.
Qed.

Lemma hellinger2_range : 0 <= hellinger2 p q <= 1.
Proof.
  split; [|unfold hellinger2; pose proof (overlap_nonneg p q); lra].
  rewrite hellinger2_roots. apply Rmult_le_pos; [lra|]. apply sum_nonneg. intros; apply square_nonneg.
Qed.

Lemma overlap_le_one : overlap p q <= 1.
Proof. pose proof hellinger2_range. unfold hellinger2 in *. lra. Qed.

Let minus x := Rabs (sqrt (p x) - sqrt (q x)).
Let plus x := sqrt (p x) + sqrt (q x).

Lemma gap_factors : sum (fun x => Rabs (p x - q x)) l = sum (fun x => minus x * plus x) l.
Proof.
  apply sum_ext. intros x _. unfold minus, plus. pose proof (sqrt_pos (p x)). pose proof (sqrt_pos (q x)).
  rewrite <- (Rabs_pos_eq (sqrt (p x) + sqrt (q x))) by lra. rewrite <- Rabs_mult. f_equal.
  replace ((sqrt (p x) - sqrt (q x)) * (sqrt (p x) + sqrt (q x)))
    with (sqrt (p x) * sqrt (p x) - sqrt (q x) * sqrt (q x)) by ring. rewrite !sqrt_sqrt; auto.
Qed.

Lemma squares_minus : sum (fun x => minus x * minus x) l = 2 - 2 * overlap p q.
Proof.
  pose proof hellinger2_roots as E. unfold hellinger2 in E.
  replace (sum (fun x => minus x * minus x) l)
    with (sum (fun x => (sqrt (p x) - sqrt (q x)) * (sqrt (p x) - sqrt (q x))) l); [lra|].
  apply sum_ext. intros x _. unfold minus. rewrite <- Rabs_mult, Rabs_pos_eq; auto. apply Rle_0_sqr.
Qed.

Lemma squares_plus : sum (fun x => plus x * plus x) l = 2 + 2 * overlap p q.
Proof.
  replace (2 + 2 * overlap p q) with (sum p l + sum q l + 2 * overlap p q) by lra.
  unfold overlap. rewrite <- sum_scal, <- !sum_plus. apply sum_ext. intros x _. unfold plus.
  rewrite root_mult by auto.
  rewrite <- (sqrt_sqrt (p x)) at 3 by auto. rewrite <- (sqrt_sqrt (q x)) at 3 by auto. ring.
Qed.

Lemma tv_by_hellinger :
  total_variation p q * total_variation p q <= hellinger2 p q * (2 - hellinger2 p q).
Proof.
  unfold total_variation, hellinger2. rewrite gap_factors.
  pose proof (cauchy_schwarz minus plus l) as CS. rewrite squares_minus, squares_plus in CS. nra.
Qed.

Lemma hellinger_below_tv : hellinger2 p q <= total_variation p q.
Proof.
  assert (sum (fun x => p x + q x + (-1) * Rabs (p x - q x)) l <= 2 * overlap p q) as I.
  { unfold overlap. rewrite <- sum_scal. apply sum_le. intros x _.
    pose proof (p_nonneg x). pose proof (q_nonneg x).
    assert (Rmin (p x) (q x) <= sqrt (p x * q x)) as M.
    { unfold Rmin. destruct (Rle_dec (p x) (q x)).
      - rewrite <- (sqrt_square (p x)) at 1 by auto. apply sqrt_le_1; nra.
      - rewrite <- (sqrt_square (q x)) at 1 by auto. apply sqrt_le_1; nra. }
    unfold Rmin, Rabs in *. destruct (Rle_dec (p x) (q x)); destruct (Rcase_abs (p x - q x)); lra. }
  rewrite !sum_plus, sum_scal, p_total, q_total in I. unfold hellinger2, total_variation. lra.
Qed.

Lemma tv_nonneg : 0 <= total_variation p q.
Proof. apply Rmult_le_pos; [lra|]. apply sum_nonneg. intros; apply Rabs_pos. Qed.

(* Expectations of a function with values in an interval of length w differ by at most w times the total variation. *)
Lemma expectations_differ f low w : (forall x, In x l -> low <= f x <= low + w) ->
  Rabs (sum (fun x => p x * f x) l - sum (fun x => q x * f x) l) <= w * total_variation p q.
Proof.
  intros F.
  replace (sum (fun x => p x * f x) l - sum (fun x => q x * f x) l)
    with (sum (fun x => (p x - q x) * (f x - (low + w / 2))) l).
  - eapply Rle_trans; [apply sum_abs|]. unfold total_variation.
    replace (w * (/ 2 * sum (fun x => Rabs (p x - q x)) l)) with (w / 2 * sum (fun x => Rabs (p x - q x)) l)
      by (unfold Rdiv; ring).
    rewrite <- sum_scal. apply sum_le. intros x I. rewrite Rabs_mult, Rmult_comm.
    apply Rmult_le_compat_r; [apply Rabs_pos|]. specialize (F x I). apply Rabs_le. lra.
  - rewrite <- sum_minus.
    transitivity (sum (fun x => (p x * f x - q x * f x) + (- (low + w / 2)) * (p x - q x)) l).
    { apply sum_ext. intros; ring. }
    rewrite sum_plus, sum_scal, !sum_minus, p_total, q_total. ring.
Qed.

End Laws.
End Distances.

(* Kullback-Leibler divergence, in nats; the second law must have mass wherever the first has. *)
Definition kl {X : Type} (l : list X) (p q : X -> R) : R := sum (fun x => p x * ln (p x / q x)) l.

(* Gibbs: an expectation under q costs its divergence from the prior nu. *)
Lemma gibbs {K : Type} (l : list K) (q nu f : K -> R) :
  (forall k, In k l -> 0 < nu k) -> (forall k, In k l -> 0 <= q k) -> sum q l = 1 ->
  exp (sum (fun k => q k * f k) l - kl l q nu) <= sum (fun k => nu k * exp (f k)) l.
Proof.
  intros Pn Pq T. set (m := sum (fun k => nu k * exp (f k)) l).
  assert (Pm : 0 < m).
  { destruct (Rle_lt_or_eq_dec 0 m) as [L|E]; auto.
    - apply sum_nonneg. intros k I. apply Rlt_le, Rmult_lt_0_compat; auto. apply exp_pos.
    - exfalso. destruct l as [|k l']; [simpl in T; lra|].
      assert (0 < nu k * exp (f k)) by (apply Rmult_lt_0_compat; [apply Pn; simpl; auto|apply exp_pos]).
      assert (nu k * exp (f k) <= m); [|lra].
      apply (term_le_sum (fun k => nu k * exp (f k))); [|simpl; auto].
      intros j I. apply Rlt_le, Rmult_lt_0_compat; auto. apply exp_pos. }
  rewrite <- (exp_ln m) by auto.
  assert (sum (fun k => q k * f k) l - kl l q nu <= ln m) as Q.
  2: { destruct Q as [Q|Q]; [left; apply exp_increasing; auto|rewrite Q; lra]. }
  unfold kl. rewrite <- sum_minus.
  replace (ln m) with (sum (fun k => q k * ln m) l) by (rewrite sum_scal_r, T; ring).
  assert (sum (fun k => q k * f k - q k * ln (q k / nu k) - q k * ln m) l
    <= sum (fun k => / m * (nu k * exp (f k)) - q k) l) as Q.
  { apply sum_le. intros k I. destruct (Pq k I) as [L|E].
    - pose proof (Pn k I). set (r := nu k * exp (f k) / (q k * m)).
      assert (0 < r).
      { unfold r, Rdiv. apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat; auto; apply exp_pos|].
        apply Rinv_0_lt_compat, Rmult_lt_0_compat; auto. }
      assert (f k - ln (q k / nu k) - ln m = ln r) as El.
      { unfold r. unfold Rdiv. rewrite !ln_mult; try (apply Rinv_0_lt_compat); auto; try apply exp_pos.
        - rewrite !ln_Rinv; auto; [|apply Rmult_lt_0_compat; auto]. rewrite ln_mult, ln_exp; auto. ring.
        - apply Rmult_lt_0_compat; auto; apply exp_pos.
        - apply Rmult_lt_0_compat; auto. }
      replace (q k * f k - q k * ln (q k / nu k) - q k * ln m) with (q k * (f k - ln (q k / nu k) - ln m)) by ring.
      rewrite El. replace (/ m * (nu k * exp (f k)) - q k) with (q k * (r - 1)).
      + apply Rmult_le_compat_l; [lra|]. apply ln_le_minus_one; auto.
      + unfold r. field. lra.
    - rewrite <- E. pose proof (Pn k I). pose proof (exp_pos (f k)).
      assert (0 <= / m * (nu k * exp (f k))); [|lra].
      apply Rmult_le_pos; [left; apply Rinv_0_lt_compat; auto|]. apply Rmult_le_pos; lra. }
  rewrite sum_minus in Q.
  rewrite (sum_minus (fun k => / m * (nu k * exp (f k)))), sum_scal, T in Q. fold m in Q.
  rewrite Rinv_l in Q by lra. lra.
Qed.
