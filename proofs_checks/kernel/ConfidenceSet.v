(* A confidence set from two errors (the paper's lemma on its construction; the audit's T9).

   R1 is the error of the clone in the true environment, R2 that of the estimated environment under the expert. The
   distance of expert and clone under the estimate is at most sqrt R1 + 2 sqrt R2, whatever the policies; for
   deterministic ones the factor is the root of 2. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

(* A trajectory t has probability m t * a t: a factor of the environment times one of the policy. *)
Section Factors.
Context {T : Type} (l : list T) (m m' a b : T -> R).
Hypothesis m_nonneg : forall t, 0 <= m t.
Hypothesis m'_nonneg : forall t, 0 <= m' t.
Hypothesis a_nonneg : forall t, 0 <= a t.
Hypothesis b_nonneg : forall t, 0 <= b t.
Hypothesis expert_true : sum (fun t => m t * a t) l = 1.
Hypothesis expert_estimated : sum (fun t => m' t * a t) l = 1.
Hypothesis clone_true : sum (fun t => m t * b t) l = 1.
Hypothesis clone_estimated : sum (fun t => m' t * b t) l = 1.

Definition R1 := hellinger2 l (fun t => m t * b t) (fun t => m t * a t).
Definition R2 := hellinger2 l (fun t => m' t * a t) (fun t => m t * a t).
Definition K := hellinger2 l (fun t => m' t * a t) (fun t => m' t * b t).

Let x t := sqrt (m t).
Let y t := sqrt (m' t).
Let u t := sqrt (a t).
Let v t := sqrt (b t).

Lemma root_square f (H : forall t : T, 0 <= f t) t : sqrt (f t) * sqrt (f t) = f t.
Proof. apply sqrt_sqrt; auto. Qed.

Lemma common_kernel (k : T -> R) : (forall t, 0 <= k t) -> forall t,
  sqrt (k t * a t * (k t * b t)) = k t * (u t * v t).
Proof.
  intros Hk t. replace (k t * a t * (k t * b t)) with (k t * k t * (a t * b t)) by ring.
  rewrite sqrt_mult by (apply Rmult_le_pos; auto).
  rewrite sqrt_square by auto. rewrite sqrt_mult by auto. reflexivity.
Qed.

Lemma R1_is : R1 = 1 - sum (fun t => m t * (u t * v t)) l.
Proof.
  unfold R1, hellinger2, overlap. f_equal. apply sum_ext. intros t _.
  rewrite Rmult_comm. apply common_kernel; auto.
Qed.

Lemma K_is : K = 1 - sum (fun t => m' t * (u t * v t)) l.
Proof. unfold K, hellinger2, overlap. f_equal. apply sum_ext. intros t _. apply common_kernel; auto. Qed.

(* Replace every probability factor at t by the square of its root. *)
Ltac squares t :=
  unfold x, y, u, v;
  generalize (root_square m m_nonneg t) (root_square m' m'_nonneg t)
    (root_square a a_nonneg t) (root_square b b_nonneg t);
  generalize (sqrt (m t)) (sqrt (m' t)) (sqrt (a t)) (sqrt (b t));
  intros rm rm' ra rb Em Em' Ea Eb; rewrite <- ?Em, <- ?Em', <- ?Ea, <- ?Eb.

Lemma R2_is : 2 * R2 = sum (fun t => (y t - x t) * u t * ((y t - x t) * u t)) l.
Proof.
  assert (sum (fun t => (y t - x t) * u t * ((y t - x t) * u t)) l
    = sum (fun t => m' t * a t) l + sum (fun t => m t * a t) l
      + (-2) * sum (fun t => sqrt (m' t * a t * (m t * a t))) l) as E.
  { rewrite <- sum_scal, <- !sum_plus. apply sum_ext. intros t _.
    replace (m' t * a t * (m t * a t)) with (a t * a t * (m' t * m t)) by ring.
    rewrite sqrt_mult by (apply Rmult_le_pos; auto).
    rewrite sqrt_square, sqrt_mult by auto.
    squares t. ring. }
  unfold R2, hellinger2, overlap. rewrite E, expert_true, expert_estimated. ring.
Qed.

Lemma weighted_gap (k : T -> R) : (forall t, 0 <= k t) ->
  sum (fun t => k t * a t) l = 1 -> sum (fun t => k t * b t) l = 1 ->
  sum (fun t => sqrt (k t) * (u t - v t) * (sqrt (k t) * (u t - v t))) l
  = 2 * (1 - sum (fun t => k t * (u t * v t)) l).
Proof.
  intros Hk Ha Hb.
  assert (sum (fun t => sqrt (k t) * (u t - v t) * (sqrt (k t) * (u t - v t))) l
    = sum (fun t => k t * a t) l + sum (fun t => k t * b t) l + (-2) * sum (fun t => k t * (u t * v t)) l) as E.
  { rewrite <- sum_scal, <- !sum_plus. apply sum_ext. intros t _.
    generalize (root_square k Hk t). generalize (sqrt (k t)). intros rk Hrk. rewrite <- Hrk.
    squares t. ring. }
  rewrite E, Ha, Hb. ring.
Qed.

Lemma difference_is :
  K - R1 = sum (fun t => (y t - x t) * u t * ((y t + x t) * (u t - v t))) l.
Proof.
  assert (sum (fun t => (y t - x t) * u t * ((y t + x t) * (u t - v t))) l
    = sum (fun t => m' t * a t) l + (-1) * sum (fun t => m t * a t) l
      + (-1) * sum (fun t => m' t * (u t * v t)) l + sum (fun t => m t * (u t * v t)) l) as E.
  { rewrite <- !sum_scal, <- !sum_plus. apply sum_ext. intros t _. squares t. ring. }
  rewrite E, K_is, R1_is, expert_true, expert_estimated. ring.
Qed.

Lemma nonneg_R2 : 0 <= R2.
Proof.
  assert (0 <= 2 * R2) by (rewrite R2_is; apply sum_nonneg; intros; apply square_nonneg). lra.
Qed.

Lemma nonneg_R1 : 0 <= R1.
Proof.
  pose proof (weighted_gap m m_nonneg expert_true clone_true) as H. rewrite R1_is.
  assert (0 <= sum (fun t => sqrt (m t) * (u t - v t) * (sqrt (m t) * (u t - v t))) l)
    by (apply sum_nonneg; intros; apply square_nonneg).
  lra.
Qed.

Lemma nonneg_K : 0 <= K.
Proof.
  pose proof (weighted_gap m' m'_nonneg expert_estimated clone_estimated) as H. rewrite K_is.
  assert (0 <= sum (fun t => sqrt (m' t) * (u t - v t) * (sqrt (m' t) * (u t - v t))) l)
    by (apply sum_nonneg; intros; apply square_nonneg).
  lra.
Qed.

(* One Cauchy-Schwarz for each of the two summands of (y + x)(u - v). *)
Lemma piece (k : T -> R) (error : R) : (forall t, 0 <= k t) ->
  sum (fun t => k t * a t) l = 1 -> sum (fun t => k t * b t) l = 1 ->
  error = 1 - sum (fun t => k t * (u t * v t)) l ->
  sum (fun t => (y t - x t) * u t * (sqrt (k t) * (u t - v t))) l <= 2 * (sqrt R2 * sqrt error).
Proof.
  intros Hk Ha Hb Herror.
  pose proof (cauchy_schwarz (fun t => (y t - x t) * u t) (fun t => sqrt (k t) * (u t - v t)) l) as CS.
  cbv beta in CS. rewrite (weighted_gap k Hk Ha Hb), <- R2_is, <- Herror in CS.
  assert (0 <= error).
  { pose proof (weighted_gap k Hk Ha Hb) as H. rewrite <- Herror in H.
    assert (0 <= sum (fun t => sqrt (k t) * (u t - v t) * (sqrt (k t) * (u t - v t))) l)
      by (apply sum_nonneg; intros; apply square_nonneg).
    lra. }
  pose proof nonneg_R2. pose proof (sqrt_pos R2). pose proof (sqrt_pos error).
  apply square_le; [nra|].
  replace (2 * (sqrt R2 * sqrt error) * (2 * (sqrt R2 * sqrt error)))
    with (4 * (sqrt R2 * sqrt R2) * (sqrt error * sqrt error)) by ring.
  rewrite !sqrt_sqrt by auto. lra.
Qed.

Lemma two_errors : sqrt K <= sqrt R1 + 2 * sqrt R2.
Proof.
  assert (K - R1 <= 2 * sqrt R2 * (sqrt K + sqrt R1)) as H.
  { rewrite difference_is.
    assert (sum (fun t => (y t - x t) * u t * ((y t + x t) * (u t - v t))) l
      = sum (fun t => (y t - x t) * u t * (y t * (u t - v t))) l
      + sum (fun t => (y t - x t) * u t * (x t * (u t - v t))) l) as Split.
    { rewrite <- sum_plus. apply sum_ext. intros. ring. }
    rewrite Split.
    pose proof (piece m' K m'_nonneg expert_estimated clone_estimated K_is).
    pose proof (piece m R1 m_nonneg expert_true clone_true R1_is).
    unfold x, y in *. lra. }
  pose proof nonneg_K. pose proof nonneg_R1. pose proof nonneg_R2.
  pose proof (sqrt_pos K). pose proof (sqrt_pos R1). pose proof (sqrt_pos R2).
  replace (K - R1) with ((sqrt K - sqrt R1) * (sqrt K + sqrt R1)) in H.
  2: { replace ((sqrt K - sqrt R1) * (sqrt K + sqrt R1)) with (sqrt K * sqrt K - sqrt R1 * sqrt R1) by ring.
       rewrite !sqrt_sqrt; auto. }
  destruct (Req_dec (sqrt K + sqrt R1) 0) as [Z|N].
  - lra.
  - assert (sqrt K - sqrt R1 <= 2 * sqrt R2).
    { apply Rmult_le_reg_r with (sqrt K + sqrt R1); lra. }
    lra.
Qed.

(* Deterministic policies: factors 0 or 1, and the root of 2 instead of 2. *)
Hypothesis a_bit : forall t, a t = 0 \/ a t = 1.
Hypothesis b_bit : forall t, b t = 0 \/ b t = 1.

Lemma root_of_bit (f : T -> R) t : f t = 0 \/ f t = 1 -> sqrt (f t) = f t.
Proof. intros [E|E]; rewrite E; [apply sqrt_0|apply sqrt_1]. Qed.

Lemma piece_bits (k : T -> R) (error : R) : (forall t, 0 <= k t) ->
  sum (fun t => k t * a t) l = 1 ->
  error = 1 - sum (fun t => k t * (u t * v t)) l ->
  sum (fun t => (y t - x t) * u t * (sqrt (k t) * (u t - v t))) l <= sqrt (2 * R2) * sqrt error.
Proof.
  intros Hk Ha Herror.
  assert (sum (fun t => sqrt (k t) * (u t * (u t - v t)) * (sqrt (k t) * (u t * (u t - v t)))) l = error) as E.
  { replace error with (sum (fun t => k t * a t) l + (-1) * sum (fun t => k t * (u t * v t)) l) by lra.
    rewrite <- sum_scal, <- sum_plus. apply sum_ext. intros t _.
    generalize (root_square k Hk t). generalize (sqrt (k t)). intros rk Hrk. rewrite <- Hrk.
    unfold u, v. rewrite !root_of_bit by auto.
    destruct (a_bit t) as [Ea|Ea]; destruct (b_bit t) as [Eb|Eb]; rewrite Ea, Eb; ring. }
  assert (sum (fun t => (y t - x t) * u t * (sqrt (k t) * (u t - v t))) l
    = sum (fun t => (y t - x t) * u t * (sqrt (k t) * (u t * (u t - v t)))) l) as S.
  { apply sum_ext. intros t _. unfold u, v. rewrite !root_of_bit by auto.
    destruct (a_bit t) as [Ea|Ea]; rewrite Ea; ring. }
  rewrite S.
  pose proof (cauchy_schwarz (fun t => (y t - x t) * u t) (fun t => sqrt (k t) * (u t * (u t - v t))) l) as CS.
  cbv beta in CS. rewrite E, <- R2_is in CS.
  assert (0 <= error) by (rewrite <- E; apply sum_nonneg; intros; apply square_nonneg).
  pose proof nonneg_R2. pose proof (sqrt_pos (2 * R2)). pose proof (sqrt_pos error).
  apply square_le; [nra|].
  replace (sqrt (2 * R2) * sqrt error * (sqrt (2 * R2) * sqrt error))
    with ((sqrt (2 * R2) * sqrt (2 * R2)) * (sqrt error * sqrt error)) by ring.
  rewrite !sqrt_sqrt by lra. lra.
Qed.

Lemma two_errors_deterministic : sqrt K <= sqrt R1 + sqrt (2 * R2).
Proof.
  assert (K - R1 <= sqrt (2 * R2) * (sqrt K + sqrt R1)) as H.
  { rewrite difference_is.
    assert (sum (fun t => (y t - x t) * u t * ((y t + x t) * (u t - v t))) l
      = sum (fun t => (y t - x t) * u t * (y t * (u t - v t))) l
      + sum (fun t => (y t - x t) * u t * (x t * (u t - v t))) l) as Split.
    { rewrite <- sum_plus. apply sum_ext. intros. ring. }
    rewrite Split.
    pose proof (piece_bits m' K m'_nonneg expert_estimated K_is).
    pose proof (piece_bits m R1 m_nonneg expert_true R1_is).
    unfold x, y in *. lra. }
  pose proof nonneg_K. pose proof nonneg_R1.
  pose proof (sqrt_pos K). pose proof (sqrt_pos R1). pose proof (sqrt_pos (2 * R2)).
  replace (K - R1) with ((sqrt K - sqrt R1) * (sqrt K + sqrt R1)) in H.
  2: { replace ((sqrt K - sqrt R1) * (sqrt K + sqrt R1)) with (sqrt K * sqrt K - sqrt R1 * sqrt R1) by ring.
       rewrite !sqrt_sqrt; auto. }
  destruct (Req_dec (sqrt K + sqrt R1) 0) as [Z|N].
  - lra.
  - assert (sqrt K - sqrt R1 <= sqrt (2 * R2)).
    { apply Rmult_le_reg_r with (sqrt K + sqrt R1); lra. }
    lra.
Qed.

End Factors.

Section ConfidenceSet.
Context {St Ac : finite} (Phat Pstar : environment St Ac) (H : nat).

(* The error of the clone, that of the estimate, and the distance that defines the set. *)
Definition policy_error (expert clone : policy St Ac) : R :=
  hellinger2 (trajectories H) (trajectory_law Pstar clone) (trajectory_law Pstar expert).
Definition transition_error (expert : policy St Ac) : R :=
  hellinger2 (trajectories H) (trajectory_law Phat expert) (trajectory_law Pstar expert).
Definition distance_to_clone (expert clone : policy St Ac) : R :=
  hellinger (trajectories H) (trajectory_law Phat expert) (trajectory_law Phat clone).

Lemma by_factors (E E' : environment St Ac) pi pi' :
  hellinger2 (trajectories H) (trajectory_law E pi) (trajectory_law E' pi')
  = hellinger2 (trajectories H) (fun t => dynamics_factor E t * policy_factor pi t)
      (fun t => dynamics_factor E' t * policy_factor pi' t).
Proof. unfold hellinger2, overlap. f_equal. apply sum_ext. intros. rewrite !factorisation. reflexivity. Qed.

Lemma factors_total (E : environment St Ac) pi :
  sum (fun t => dynamics_factor E t * policy_factor pi t) (trajectories H) = 1.
Proof. rewrite <- (trajectory_law_total E pi H). apply sum_ext. intros. rewrite factorisation. reflexivity. Qed.

(* label: audit T9 *)
Theorem confidence_set (expert clone : policy St Ac) :
  distance_to_clone expert clone <= sqrt (policy_error expert clone) + 2 * sqrt (transition_error expert).
Proof.
  unfold distance_to_clone, hellinger, policy_error, transition_error. rewrite !by_factors.
  apply two_errors; auto using dynamics_factor_nonneg, policy_factor_nonneg, factors_total.
Qed.

Lemma policy_error_nonneg expert clone : 0 <= policy_error expert clone.
Proof. apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total. Qed.

Lemma transition_error_nonneg expert : 0 <= transition_error expert.
Proof. apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total. Qed.

(* The paper's lemma for all policies: its factor of the second error is at least 2. *)
(* label: lemma:confidence_set_construction_main *)
Theorem confidence_set_stated (expert clone : policy St Ac) (r1 r2 horizon gamma : R) :
  policy_error expert clone <= r1 -> transition_error expert <= r2 -> 1 <= horizon -> 0 < gamma ->
  distance_to_clone expert clone <= sqrt r1 + sqrt r2 * (1 + sqrt (horizon * (1 + 2 * sqrt r1 / gamma))).
Proof.
  intros L1 L2 Hh Hg. pose proof (confidence_set expert clone).
  pose proof (policy_error_nonneg expert clone). pose proof (transition_error_nonneg expert).
  assert (sqrt (policy_error expert clone) <= sqrt r1) by (apply sqrt_le_1; lra).
  assert (sqrt (transition_error expert) <= sqrt r2) by (apply sqrt_le_1; lra).
  pose proof (sqrt_pos r1). pose proof (sqrt_pos r2).
  assert (0 <= 2 * sqrt r1 / gamma).
  { unfold Rdiv. apply Rmult_le_pos; [lra|]. left. apply Rinv_0_lt_compat; lra. }
  assert (1 <= sqrt (horizon * (1 + 2 * sqrt r1 / gamma))).
  { rewrite <- sqrt_1 at 1. apply sqrt_le_1; nra. }
  nra.
Qed.

Lemma deterministic_bit (f : St -> Ac) t :
  policy_factor (deterministic f) t = 0 \/ policy_factor (deterministic f) t = 1.
Proof. rewrite deterministic_factor. destruct (follows f t); simpl; auto. Qed.

(* label: audit T9 *)
Theorem confidence_set_deterministic (expert clone : St -> Ac) :
  distance_to_clone (deterministic expert) (deterministic clone)
  <= sqrt (policy_error (deterministic expert) (deterministic clone))
     + sqrt (2 * transition_error (deterministic expert)).
Proof.
  unfold distance_to_clone, hellinger, policy_error, transition_error. rewrite !by_factors.
  apply two_errors_deterministic;
    auto using dynamics_factor_nonneg, policy_factor_nonneg, factors_total, deterministic_bit.
Qed.

End ConfidenceSet.

Example confidence_set_nonvacuous :
  distance_to_clone estimated 3 random_policy (deterministic keep)
  <= sqrt (policy_error small 3 random_policy (deterministic keep))
     + 2 * sqrt (transition_error estimated small 3 random_policy).
Proof. apply confidence_set. Qed.

Example confidence_set_stated_nonvacuous :
  distance_to_clone estimated 3 random_policy (deterministic keep)
  <= sqrt 1 + sqrt 1 * (1 + sqrt (3 * (1 + 2 * sqrt 1 / / 4))).
Proof.
  apply confidence_set_stated with (Pstar := small); try lra;
    apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total.
Qed.

Example confidence_set_deterministic_nonvacuous :
  distance_to_clone estimated 3 (deterministic stay_in_first) (deterministic keep)
  <= sqrt (policy_error small 3 (deterministic stay_in_first) (deterministic keep))
     + sqrt (2 * transition_error estimated small 3 (deterministic stay_in_first)).
Proof. apply confidence_set_deterministic. Qed.
