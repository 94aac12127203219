(* The elliptical potential
  (the audit's R3) under the recursion of the determinant, and the transfer of total variation
   between environments (R8(b)). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

(* The price of the steepest step. *)
Definition step_price (a : R) : R := a / ln (1 + a).

Lemma exp_below_chord L l : 0 <= l <= 1 -> exp (l * L) <= 1 - l + l * exp L.
Proof.
  intros R0. pose proof (exp_pos (l * L)) as P.
  assert (exp (l * L) * (1 - l * L) <= 1) as T1.
  { pose proof (one_plus_le_exp (- (l * L))) as Q.
    assert (exp (l * L) * exp (- (l * L)) = 1) as E by (rewrite <- exp_plus, Rplus_opp_r; apply exp_0).
    assert (exp (l * L) * (1 + - (l * L)) <= exp (l * L) * exp (- (l * L))) by (apply Rmult_le_compat_l; lra). lra. }
  assert (exp (l * L) * (1 + (1 - l) * L) <= exp L) as T2.
  { pose proof (one_plus_le_exp ((1 - l) * L)) as Q.
    assert (exp (l * L) * exp ((1 - l) * L) = exp L) as E by (rewrite <- exp_plus; f_equal; ring).
    assert (exp (l * L) * (1 + (1 - l) * L) <= exp (l * L) * exp ((1 - l) * L)) by (apply Rmult_le_compat_l;
      lra). lra. }
  assert ((1 - l) * (exp (l * L) * (1 - l * L)) <= (1 - l) * 1) by (apply Rmult_le_compat_l; lra).
  assert (l * (exp (l * L) * (1 + (1 - l) * L)) <= l * exp L) by (apply Rmult_le_compat_l; lra).
  replace (exp (l * L)) with ((1 - l) * (exp (l * L) * (1 - l * L)) + l * (exp (l * L) * (1 + (1 - l) * L))) by ring.
  lra.
Qed.

Lemma log_one_plus_pos a : 0 < a -> 0 < ln (1 + a).
Proof. intros P. rewrite <- ln_1. apply ln_increasing; lra. Qed.

Lemma below_priced_log a u : 0 < a -> 0 <= u <= a -> u <= step_price a * ln (1 + u).
Proof.
  intros Pa Pu. pose proof (log_one_plus_pos a Pa) as PL. set (L := ln (1 + a)) in *.
  assert (l0 : 0 <= u / a <= 1).
  { split; [unfold Rdiv; apply Rmult_le_pos; [lra|left; apply Rinv_0_lt_compat; auto]|].
    apply Rmult_le_reg_r with a; auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  pose proof (exp_below_chord L (u / a) l0) as Q. unfold L in Q at 2. rewrite exp_ln in Q by lra.
  replace (1 - u / a + u / a * (1 + a)) with (1 + u) in Q by (field; lra).
  assert (u / a * L <= ln (1 + u)) as K.
  { rewrite <- (ln_exp (u / a * L)). destruct Q as [Q| ->]; [left; apply ln_increasing; auto; apply exp_pos|lra]. }
  unfold step_price. fold L. assert (a / L * (u / a * L) = u) as E by (field; lra). rewrite <- E at 1.
  apply Rmult_le_compat_l; auto. unfold Rdiv. apply Rmult_le_pos; [lra|]. left. apply Rinv_0_lt_compat; auto.
Qed.

(* u_t is the squared norm of x_t in the inverse of V_t; det V_{t+1} = det V_t (1 + u_t) is the stated hypothesis. *)
Section Potential.
Variables (a det_first det_last : R) (us : list R).
Hypothesis a_pos : 0 < a.
Hypothesis steps_bounded : forall u, In u us -> 0 <= u <= a.
Hypothesis det_pos : 0 < det_first.
Hypothesis determinant_recursion : det_last = det_first * product (fun u => 1 + u) us.

(* label: audit R3 *)
Theorem elliptical_potential : sum (fun u => u) us <= step_price a * ln (det_last / det_first).
Proof.
  rewrite determinant_recursion.
  replace (det_first * product (fun u => 1 + u) us / det_first) with (product (fun u => 1 + u) us) by (field; lra).
  clear determinant_recursion. induction us as [|u us' IH]; [simpl; rewrite ln_1; lra|]. cbn [sum product].
  rewrite ln_mult.
  - pose proof (below_priced_log a u a_pos (steps_bounded u (or_introl eq_refl))).
    assert (sum (fun u0 => u0) us' <= step_price a * ln (product (fun u0 => 1 + u0) us'))
      by (apply IH; intros; apply steps_bounded; right; auto).
    lra.
  - pose proof (steps_bounded u (or_introl eq_refl)). lra.
  - apply product_pos. intros x I. pose proof (steps_bounded x (or_intror I)). lra.
Qed.

(* label: audit R3 *)
Theorem elliptical_potential_of_norms :
  sum sqrt us <= sqrt (INR (length us) * (step_price a * ln (det_last / det_first))).
Proof.
  apply square_le; [apply sqrt_pos|].
  pose proof (cauchy_schwarz (fun _ : R => 1) sqrt us) as CS. cbv beta in CS.
  rewrite !(sum_ext (fun x => 1 * sqrt x) sqrt) in CS by (intros; ring).
  rewrite (sum_ext (fun _ => 1 * 1) (fun _ => 1)), sum_const, Rmult_1_r in CS by (intros; ring).
  rewrite (sum_ext (fun x => sqrt x * sqrt x) (fun u => u)) in CS
    by (intros u I; apply sqrt_sqrt; pose proof (steps_bounded u I); lra).
  pose proof elliptical_potential as P. pose proof (pos_INR (length us)) as N0.
  assert (INR (length us) * sum (fun u => u) us <= INR (length us) * (step_price a * ln (det_last / det_first))) as Q
    by (apply Rmult_le_compat_l; auto).
  rewrite sqrt_sqrt; [lra|]. eapply Rle_trans; [|exact Q]. apply Rmult_le_pos; auto.
  apply sum_nonneg. intros u I. pose proof (steps_bounded u I). lra.
Qed.

End Potential.

(* R8(b): how far two policies are apart does not change more between environments than the law of one of them. *)
Section Transfer.
Context {St Ac : finite} (P Q : environment St Ac) (pi pi' : policy St Ac) (H : nat).

(* The relative shortfall of the first policy's factor; it is 0 where the second policy has none. *)
Definition shortfall (t : trajectory St Ac) : R := Rmax 0 (1 - policy_factor pi t / policy_factor pi' t).

Lemma shortfall_range t : 0 <= shortfall t <= 1.
Proof.
  unfold shortfall. split; [apply Rmax_l|]. apply Rmax_lub; [lra|].
  pose proof (policy_factor_nonneg pi t). destruct (policy_factor_nonneg pi' t) as [L|Z].
  - assert (0 <= policy_factor pi t / policy_factor pi' t); [|lra].
    unfold Rdiv. apply Rmult_le_pos; auto. left. apply Rinv_0_lt_compat; auto.
  - rewrite <- Z. unfold Rdiv. rewrite Rinv_0. lra.
Qed.

Lemma variation_by_shortfall (E : environment St Ac) :
  total_variation (trajectories H) (trajectory_law E pi) (trajectory_law E pi')
  = sum (fun t => trajectory_law E pi' t * shortfall t) (trajectories H).
Proof.
  unfold total_variation.
  replace (sum (fun t => Rabs (trajectory_law E pi t - trajectory_law E pi' t)) (trajectories H))
    with (sum (fun t => trajectory_law E pi t - trajectory_law E pi' t
      + 2 * (trajectory_law E pi' t * shortfall t)) (trajectories H)).
  - rewrite sum_plus, sum_minus, sum_scal, !trajectory_law_total. field.
  - apply sum_ext. intros t _. rewrite !factorisation. pose proof (dynamics_factor_nonneg E t) as N0.
    pose proof (policy_factor_nonneg pi t) as N1. destruct (policy_factor_nonneg pi' t) as [L|Z].
    + unfold shortfall. set (m := dynamics_factor E t) in *. set (x := policy_factor pi t) in *.
      set (y := policy_factor pi' t) in *.
      destruct (Rle_lt_dec x y) as [C0|C0].
      * assert (x / y <= 1).
        { apply Rmult_le_reg_r with y; auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
        rewrite Rmax_right by lra. rewrite Rabs_left1 by nra. field. lra.
      * assert (1 <= x / y).
        { apply Rmult_le_reg_r with y; auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
        rewrite Rmax_left by lra. rewrite Rabs_pos_eq by nra. ring.
    + rewrite <- Z, !Rmult_0_r, !Rmult_0_l, Rmult_0_r, Rplus_0_r, Rminus_0_r. symmetry. apply Rabs_pos_eq.
      apply Rmult_le_pos; auto.
Qed.

(* label: audit R8(b) *)
Theorem variation_transfers :
  Rabs (total_variation (trajectories H) (trajectory_law P pi) (trajectory_law P pi')
        - total_variation (trajectories H) (trajectory_law Q pi) (trajectory_law Q pi'))
  <= total_variation (trajectories H) (trajectory_law P pi') (trajectory_law Q pi').
Proof.
  rewrite !variation_by_shortfall.
  pose proof (expectations_differ (trajectories H) (trajectory_law P pi') (trajectory_law Q pi')
    (trajectory_law_total P pi' H) (trajectory_law_total Q pi' H) shortfall 0 1) as B.
  rewrite Rmult_1_l in B. apply B. intros t _. pose proof (shortfall_range t). lra.
Qed.

End Transfer.

Section Examples.

Example elliptical_potential_nonvacuous : sum (fun u => u) [1; / 2] <= step_price 1 * ln (3 / 1).
Proof. apply elliptical_potential; [lra| |lra|simpl; field]. intros u [<-|[<-|[]]]; lra. Qed.

Example elliptical_potential_of_norms_nonvacuous :
  sum sqrt [1; / 2] <= sqrt (INR (length [1; / 2]) * (step_price 1 * ln (3 / 1))).
Proof. apply elliptical_potential_of_norms; [lra| |lra|simpl; field]. intros u [<-|[<-|[]]]; lra. Qed.

Example variation_transfers_nonvacuous :
  Rabs (total_variation (trajectories 3) (trajectory_law estimated random_policy) (trajectory_law estimated
    (deterministic keep))
        - total_variation (trajectories 3) (trajectory_law small random_policy) (trajectory_law small
          (deterministic keep)))
  <= total_variation (trajectories 3) (trajectory_law estimated (deterministic keep)) (trajectory_law small
    (deterministic keep)).
Proof. apply variation_transfers. Qed.

End Examples.
