(* Vectors of features, and the logistic function with the tangent of its logarithm. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums.
Import ListNotations.
Open Scope R_scope.

Definition vector : Type := nat -> R.

Section Vectors.
Variable d : nat.
Implicit Types u v w : vector.

Definition dot u v : R := sum (fun i => u i * v i) (seq 0 d).
Definition norm u : R := sqrt (dot u u).
Definition add u v : vector := fun i => u i + v i.
Definition minus u v : vector := fun i => u i - v i.
Definition scale (c : R) u : vector := fun i => c * u i.
Definition zero : vector := fun _ => 0.

Lemma dot_sym u v : dot u v = dot v u.
Proof. apply sum_ext. intros; ring. Qed.

Lemma dot_add u v w : dot (add u v) w = dot u w + dot v w.
Proof. unfold dot, add. rewrite <- sum_plus. apply sum_ext. intros; ring. Qed.

Lemma dot_minus u v w : dot (minus u v) w = dot u w - dot v w.
Proof. unfold dot, minus. rewrite <- sum_minus. apply sum_ext. intros; ring. Qed.

Lemma dot_minus_r w u v : dot w (minus u v) = dot w u - dot w v.
Proof. rewrite dot_sym, dot_minus, !(dot_sym w). reflexivity. Qed.

Lemma dot_scale c u w : dot (scale c u) w = c * dot u w.
Proof. unfold dot, scale. rewrite <- sum_scal. apply sum_ext. intros; ring. Qed.

Lemma dot_zero w : dot zero w = 0.
Proof. transitivity (sum (fun _ : nat => 0) (seq 0 d)); [apply sum_ext; intros; unfold zero;
  ring|apply sum_zero]. Qed.

Lemma dot_self_nonneg u : 0 <= dot u u.
Proof. apply sum_nonneg. intros; apply square_nonneg. Qed.

Lemma dot_le_norms u v : dot u v <= norm u * norm v.
Proof.
  apply square_le; [apply Rmult_le_pos; apply sqrt_pos|]. unfold norm.
  replace (sqrt (dot u u) * sqrt (dot v v) * (sqrt (dot u u) * sqrt (dot v v)))
    with ((sqrt (dot u u) * sqrt (dot u u)) * (sqrt (dot v v) * sqrt (dot v v))) by ring.
  rewrite !sqrt_sqrt by apply dot_self_nonneg. apply cauchy_schwarz.
Qed.

(* The ball of weights, and what its support function is. *)
Definition ball (W : R) (w : vector) : Prop := norm w <= W.

(* s bounds every linear function on a set of weights: the support function of a convex set does. *)
Definition supports (s : vector -> R) (weights : vector -> Prop) : Prop :=
  forall u w, weights w -> dot u w <= s u.

Lemma ball_supports W : supports (fun u => W * norm u) (ball W).
Proof.
  intros u w B. pose proof (dot_le_norms u w). unfold ball in B.
  pose proof (sqrt_pos (dot u u)). unfold norm in *. nra.
Qed.

End Vectors.

Definition logistic (z : R) : R := / (1 + exp (- z)).

Lemma logistic_pos z : 0 < logistic z.
Proof. apply Rinv_0_lt_compat. pose proof (exp_pos (- z)). lra. Qed.

Lemma logistic_opp z : logistic (- z) = exp (- z) * logistic z.
Proof.
  unfold logistic. rewrite Ropp_involutive, exp_Ropp. pose proof (exp_pos z). field. split; lra.
Qed.

Lemma logistic_total z : logistic z + logistic (- z) = 1.
Proof. rewrite logistic_opp. unfold logistic. pose proof (exp_pos (- z)). field. lra. Qed.

(* The logarithm of the logistic function lies below its tangents. *)
Lemma log_logistic_tangent z z0 : ln (logistic z) <= ln (logistic z0) + logistic (- z0) * (z - z0).
Proof.
  set (a := logistic z0). set (b := logistic (- z0)). set (y := z - z0).
  assert (Pa : 0 < a) by apply logistic_pos. assert (Pb : 0 < b) by apply logistic_pos.
  assert (T : a + b = 1) by apply logistic_total.
  assert (E : a = logistic z * (a + b * exp (- y))).
  { unfold b. rewrite logistic_opp. fold a. unfold y.
    replace (exp (- z0) * a * exp (- (z - z0))) with (a * exp (- z)).
    - unfold logistic at 1. pose proof (exp_pos (- z)). field. lra.
    - replace (exp (- z)) with (exp (- z0) * exp (- (z - z0))) by (rewrite <- exp_plus; f_equal; ring). ring. }
  assert (I : exp (- (b * y)) <= a + b * exp (- y)).
  { pose proof (one_plus_le_exp (b * y)) as Q1. pose proof (one_plus_le_exp (- (a * y))) as Q2.
    assert (1 <= a * exp (b * y) + b * exp (- (a * y))) as Q by nra.
    apply Rmult_le_reg_l with (exp (b * y)); [apply exp_pos|].
    rewrite <- exp_plus. replace (b * y + - (b * y)) with 0 by ring. rewrite exp_0.
    replace (exp (b * y) * (a + b * exp (- y))) with (a * exp (b * y) + b * (exp (b * y) * exp (- y))) by ring.
    rewrite <- exp_plus. replace (b * y + - y) with (- (a * y)); auto.
    replace b with (1 - a) by lra. ring. }
  pose proof (logistic_pos z) as Pz. pose proof (exp_pos (- (b * y))) as Pe.
  assert (L : ln a = ln (logistic z) + ln (a + b * exp (- y))).
  { rewrite E at 1. apply ln_mult; lra. }
  assert (- (b * y) <= ln (a + b * exp (- y))).
  { rewrite <- (ln_exp (- (b * y))). destruct I as [I|I]; [left; apply ln_increasing; auto|rewrite I; lra]. }
  fold y. lra.
Qed.
