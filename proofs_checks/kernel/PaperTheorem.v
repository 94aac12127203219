(* The paper's offline statements for deterministic experts, with
  the paper's own constants, from the repaired ones. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet
  Bridge.Deterministic Bridge.Cloning.
Require Import Bridge.CountEstimate Bridge.OfflineTheorem Bridge.Small Bridge.Arithmetic Bridge.Formulas.
Import ListNotations.
Open Scope R_scope.

Lemma ln_nonneg x : 1 <= x -> 0 <= ln x.
Proof. intros P. rewrite <- ln_1. destruct P as [P|<-]; [left; apply ln_increasing; lra|lra]. Qed.

Lemma ln_monotone x y : 0 < x -> x <= y -> ln x <= ln y.
Proof. intros P [L|<-]; [left; apply ln_increasing; auto|lra]. Qed.

Lemma inverse_at_least_one x : 0 < x <= 1 -> 1 <= / x.
Proof. intros P. rewrite <- Rinv_1. apply Rinv_le_contravar; lra. Qed.

Lemma binomial_below_power n k : (k <= n)%nat -> C n k <= INR n ^ k.
Proof.
  induction k as [|k IH]; intros L; [rewrite C_zero; simpl; lra|]. rewrite C_step by lia.
  assert (C n k <= INR n ^ k) as Q by (apply IH; lia). clear IH.
  assert (0 < C n k) as P.
  { unfold C, Rdiv. apply Rmult_lt_0_compat; [apply INR_fact_lt_0|].
    apply Rinv_0_lt_compat, Rmult_lt_0_compat; apply INR_fact_lt_0. }
  pose proof (pos_INR k). pose proof (pos_INR n). apply le_INR in L. rewrite S_INR in L.
  apply Rle_trans with (C n k * INR n).
  - unfold Rdiv. rewrite Rmult_assoc. apply Rmult_le_compat_l; [lra|].
    apply Rmult_le_reg_r with (INR k + 1); [lra|]. rewrite Rmult_assoc, Rinv_l by lra. nra.
  - simpl. rewrite (Rmult_comm (INR n)). apply Rmult_le_compat_r; auto.
Qed.

Section Stated.
Context {St Ac : finite} (start : law St) (Pstar : St -> Ac -> law St) (expert : St -> Ac) (H n : nat).

Notation data := (list (trajectory St Ac)).
Notation truth := (markov start Pstar).
Notation demos := (demonstrations truth (deterministic expert) H).
Notation A := (INR (size Ac)).
Notation S := (INR (size St)).

Variable clone : data -> St -> Ac.
Hypothesis clone_maximises : clones truth expert clone.

Lemma states_at_least_one : 1 <= S.
Proof.
  destruct (some_mass start) as [s _]. change 1 with (INR 1). apply le_INR. unfold size.
  pose proof (complete St s). destruct (elements St); [contradiction|simpl; lia].
Qed.

Lemma actions_at_least_one : 1 <= A.
Proof.
  destruct (some_mass start) as [s _]. change 1 with (INR 1). apply le_INR. unfold size.
  pose proof (complete Ac (expert s)). destruct (elements Ac); [contradiction|simpl; lia].
Qed.

Lemma one_action (a a' : Ac) : A < 2 -> a = a'.
Proof.
  intros L. change 2 with (INR 2) in L. apply INR_lt in L. unfold size in L.
  pose proof (complete Ac a) as I. pose proof (complete Ac a') as J.
  destruct (elements Ac) as [|b [|b' l]]; simpl in *; [contradiction| |lia].
  destruct I as [<-|[]]. destruct J as [<-|[]]. reflexivity.
Qed.

(* The error of the clone with the theorem's constant 4. *)
(* label: local:policy_and_transition_error *)
Theorem policy_error_as_stated delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    policy_error truth H (deterministic expert) (deterministic (clone D))
    <= policy_error_stated (size St) (size Ac) n delta).
Proof.
  intros Pn Pd. pose proof (lt_0_INR n Pn) as Pn'. pose proof states_at_least_one as PS.
  pose proof actions_at_least_one as PA. pose proof (inverse_at_least_one delta Pd) as Pi.
  eapply with_probability_impl; [|apply clone_error_bound; eauto]. intros D _ _ B. cbv beta in B.
  unfold policy_error_stated, Rdiv in *. destruct (Rlt_le_dec A 2) as [L|L].
  - assert (policy_error truth H (deterministic expert) (deterministic (clone D)) = 0) as ->.
    + unfold policy_error. destruct (deterministic_distance truth H (clone D) expert) as [-> _].
      apply Rle_antisym; [|apply Pr_range]. unfold hit.
      rewrite <- (expect_const (run truth (deterministic expert)) H 0). apply expect_le. intros t _ _.
      replace (visits (differ (clone D) expert) t) with false; [simpl; lra|]. symmetry. apply visits_none.
      intros s a _. unfold differ. rewrite (one_action (clone D s) (expert s) L), eqb_refl. reflexivity.
    + apply Rmult_le_pos; [|left; apply Rinv_0_lt_compat; auto]. apply Rmult_le_pos; [lra|].
      apply ln_nonneg. nra.
  - eapply Rle_trans; [exact B|]. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|].
    assert (ln (2 * / delta) <= ln (A * / delta)) as L1 by (apply ln_monotone; nra).
    rewrite ln_mult in L1 by lra. pose proof (ln_nonneg (/ delta) Pi). pose proof ln_lt_2. nra.
Qed.

(* The corollary's constant 6: the set around the clone with known dynamics. *)
(* label: lem:offline_CI_under_known_dyn *)
Theorem known_dynamics_as_stated delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    hellinger (trajectories H) (trajectory_law truth (deterministic expert))
      (trajectory_law truth (deterministic (clone D)))
    <= offline_radius_known (size St) (size Ac) n delta).
Proof.
  intros Pn Pd. pose proof (lt_0_INR n Pn) as Pn'. pose proof states_at_least_one as PS.
  pose proof actions_at_least_one as PA. pose proof (inverse_at_least_one delta Pd) as Pi.
  eapply with_probability_impl; [|apply policy_error_as_stated; eauto]. intros D _ _ B. cbv beta in B.
  unfold hellinger, offline_radius_known. apply sqrt_le_1_alt. rewrite hellinger2_sym. fold truth.
  eapply Rle_trans; [exact B|]. unfold policy_error_stated, policy_error_corollary, Rdiv.
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|].
  assert (0 <= ln (A * / delta)) by (apply ln_nonneg; nra). nra.
Qed.

Variable Phat : data -> St -> Ac -> law St.
Hypothesis Phat_likeliest : forall D, possible truth (deterministic expert) D -> likeliest_kernel D (Phat D).

Lemma distance_at_most_one D : distance_to_clone (markov start (Phat D)) H (deterministic expert)
  (deterministic (clone D)) <= 1.
Proof.
  unfold distance_to_clone, hellinger. rewrite <- sqrt_1. apply sqrt_le_1_alt.
  apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total.
Qed.

Lemma root_of_quotient x y : 0 <= x -> 0 < y -> sqrt (x / y) = sqrt x / sqrt y.
Proof. intros. apply sqrt_div; auto. Qed.

(* The paper's theorem: its radius covers the expert, for every maximum-likelihood clone and kernel.
  Its condition on the
   least visitation probability is not needed: any positive number may stand in its place. *)
(* label: thm:tabular_confidence_set *)
Theorem tabular_confidence_set delta gamma_min : (0 < n)%nat -> (0 < H)%nat -> 0 < delta <= 1 -> 0 < gamma_min ->
  with_probability demos (1 - delta) n (fun D =>
    distance_to_clone (markov start (Phat D)) H (deterministic expert) (deterministic (clone D))
    <= offline_radius (size St) (size Ac) H n delta gamma_min).
Proof.
  intros Pn Ph Pd Pg. pose proof (lt_0_INR n Pn) as Pn'. pose proof states_at_least_one as PS.
  pose proof actions_at_least_one as PA. pose proof (inverse_at_least_one delta Pd) as Pi.
  assert (Hn : 1 <= INR n) by (change 1 with (INR 1); apply le_INR; lia).
  assert (Hh : 1 <= INR H) by (change 1 with (INR 1); apply le_INR; lia).
  set (a2 := 4 * S * ln (2 * A / delta)). set (L := ln (2 * INR n * INR H / delta)).
  set (b2 := 4 * S ^ 2 * A * L).
  assert (L0 : / 2 < L).
  { eapply Rlt_le_trans; [apply ln_lt_2|]. unfold L, Rdiv. apply ln_monotone; [lra|].
    assert (1 <= INR n * INR H) by nra. nra. }
  assert (La : ln 2 + ln (/ delta) <= ln (2 * A / delta)).
  { rewrite <- ln_mult by lra. unfold Rdiv. apply ln_monotone; [nra|]. nra. }
  pose proof ln_lt_2 as L2. pose proof (ln_nonneg (/ delta) Pi) as Ld.
  assert (Pa : 0 <= a2) by (unfold a2; nra).
  assert (Pb : 0 <= b2).
  { unfold b2. apply Rmult_le_pos; [|lra]. apply Rmult_le_pos; [|lra]. apply Rmult_le_pos; [lra|].
    apply pow_le; lra. }
  assert (Rn : 0 < sqrt (INR n)) by (apply sqrt_lt_R0; auto).
  assert (Radius : sqrt (a2 / INR n) + sqrt (4 * (b2 / INR n)) <=
    offline_radius (size St) (size Ac) H n delta gamma_min).
  { unfold offline_radius, alpha_offline, beta_offline. fold L. fold b2. fold a2.
    replace (sqrt (4 * (b2 / INR n))) with (2 * (sqrt b2 / sqrt (INR n))).
    2: { rewrite root_mult; [|lra|unfold Rdiv; apply Rmult_le_pos; auto; left; apply Rinv_0_lt_compat; auto].
         rewrite root_of_quotient by auto. replace 4 with (2 * 2) by ring. rewrite sqrt_square by lra. reflexivity. }
    rewrite root_of_quotient by auto. set (y := sqrt b2 / sqrt (INR n)).
    assert (Py : 0 <= y).
    { unfold y, Rdiv. apply Rmult_le_pos; [apply sqrt_pos|]. left. apply Rinv_0_lt_compat; auto. }
    assert (1 <= sqrt (INR H * (1 + 2 * sqrt a2 / (gamma_min * sqrt (INR n))))) as Q.
    { rewrite <- sqrt_1 at 1. apply sqrt_le_1_alt.
      assert (0 <= 2 * sqrt a2 / (gamma_min * sqrt (INR n))).
      { unfold Rdiv. apply Rmult_le_pos; [pose proof (sqrt_pos a2); lra|]. left. apply Rinv_0_lt_compat.
        apply Rmult_lt_0_compat; auto. }
      nra. }
    nra. }
  destruct (Rle_lt_dec 1 (4 * (b2 / INR n))) as [V|V].
  - apply with_probability_weaken with 1; [lra|]. apply surely. intros D _ _.
    eapply Rle_trans; [apply distance_at_most_one|]. eapply Rle_trans; [|exact Radius].
    pose proof (sqrt_pos (a2 / INR n)). assert (1 <= sqrt (4 * (b2 / INR n))); [|lra].
    rewrite <- sqrt_1 at 1. apply sqrt_le_1_alt. lra.
  - assert (Pnh : (0 < n * H)%nat) by (apply Nat.mul_pos_pos; auto).
    assert (Big : 2 * S - 2 <= INR n * INR H).
    { destruct (Rle_lt_dec (2 * S - 2) (INR n * INR H)) as [|Z]; auto. exfalso.
      assert (S2 : 2 <= S).
      { destruct (Rle_lt_dec 2 S) as [|Z2]; auto. exfalso. change 2 with (INR 2) in Z2.
        apply INR_lt in Z2. assert (size St <= 1)%nat as Z3 by lia. apply le_INR in Z3. simpl in Z3.
        assert (1 <= INR n * INR H) by nra. lra. }
      assert (INR n <= S * S).
      { assert (INR n <= INR n * INR H) by nra. nra. }
      assert (INR n <= 4 * b2); [|assert (4 * (b2 / INR n) = 4 * b2 * / INR n) as E by (field; lra)].
      { unfold b2. assert (S * S * (/ 2) <= S * S * L) by (apply Rmult_le_compat_l; nra).
        assert (S * S * L <= S * S * L * A).
        { rewrite <- (Rmult_1_r (S * S * L)) at 1. apply Rmult_le_compat_l; [nra|lra]. }
        replace (4 * (4 * S ^ 2 * A * L)) with (16 * (S * S * L * A)) by ring. lra. }
      rewrite E in V. assert (INR n * / INR n <= 4 * b2 * / INR n) as W
        by (apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|auto]).
      rewrite Rinv_r in W by lra. lra. }
    pose proof (policy_error_bound start Pstar expert H n clone clone_maximises (delta / 2) Pn ltac:(lra)) as E1.
    pose proof (transition_error_at start Pstar expert H n Phat Phat_likeliest (n * H) (delta / 2) Pn Pnh ltac:(lra))
      as E2.
    pose proof (two_bounds start Pstar expert H n Phat clone _ _ delta E1 E2) as E3.
    eapply with_probability_impl; [|exact E3]. clear E1 E2 E3. intros D _ _ B. cbv beta in B.
    eapply Rle_trans; [exact B|]. eapply Rle_trans; [|exact Radius].
    assert (Ln : ln (delta / 2) = - (ln 2 + ln (/ delta))).
    { unfold Rdiv. rewrite ln_mult by lra. rewrite !ln_Rinv by lra. ring. }
    apply Rplus_le_compat; apply sqrt_le_1_alt.
    + unfold policy_error_repaired. rewrite Ln. unfold Rdiv. rewrite <- Rmult_plus_distr_r.
      apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|]. unfold a2.
      assert (S * (ln 2 + ln (/ delta)) <= S * ln (2 * A / delta)) by (apply Rmult_le_compat_l; lra). nra.
    + rewrite Ln.
      assert (Ck : ln (C (n * H + 2 * size St - 2) (size St - 1)) <= (S - 1) * L).
      { assert (S1 : (1 <= size St)%nat) by (apply INR_le; simpl; lra).
        eapply Rle_trans; [apply ln_monotone; [|apply binomial_below_power; lia]|].
        - unfold C, Rdiv. apply Rmult_lt_0_compat; [apply INR_fact_lt_0|].
          apply Rinv_0_lt_compat, Rmult_lt_0_compat; apply INR_fact_lt_0.
        - assert (Ei : INR (n * H + 2 * size St - 2) = INR n * INR H + 2 * S - 2).
          { rewrite minus_INR, plus_INR, !mult_INR by lia. simpl. ring. }
          assert (1 <= INR n * INR H) by nra.
          rewrite ln_pow by lra. rewrite minus_INR by lia. simpl (INR 1). apply Rmult_le_compat_l; [lra|].
          rewrite Ei. unfold L, Rdiv. apply ln_monotone; [lra|]. nra. }
      assert (Cl : 2 * INR H * ln (1 + (S - 1) / INR (n * H)) <= 2 * (S - 1) * / INR n).
      { rewrite mult_INR. assert (0 <= (S - 1) / (INR n * INR H)).
        { unfold Rdiv. apply Rmult_le_pos; [lra|]. left. apply Rinv_0_lt_compat. nra. }
        pose proof (ln_le_minus_one (1 + (S - 1) / (INR n * INR H)) ltac:(lra)) as Q.
        apply Rle_trans with (2 * INR H * ((S - 1) / (INR n * INR H))).
        - apply Rmult_le_compat_l; lra.
        - right. field. lra. }
      assert (Lb : ln 2 + ln (/ delta) <= L).
      { rewrite <- ln_mult by lra. unfold L, Rdiv. apply ln_monotone; [nra|].
        assert (1 <= INR n * INR H) by nra. nra. }
      apply Rle_trans with (2 * ((2 * S * ((S - 1) * L) + 2 * (S - 1) + 2 * L) * / INR n)).
      * apply Rmult_le_compat_l; [lra|].
        assert (In : 0 < / INR n) by (apply Rinv_0_lt_compat; auto).
        assert (2 * S / INR n * ln (C (n * H + 2 * size St - 2) (size St - 1)) <= 2 * S * ((S - 1) * L) * / INR n).
        { replace (2 * S / INR n * ln (C (n * H + 2 * size St - 2) (size St - 1)))
            with (2 * S * ln (C (n * H + 2 * size St - 2) (size St - 1)) * / INR n) by (unfold Rdiv; ring).
          apply Rmult_le_compat_r; [lra|]. apply Rmult_le_compat_l; lra. }
        assert (-2 * - (ln 2 + ln (/ delta)) / INR n <= 2 * L * / INR n).
        { unfold Rdiv. apply Rmult_le_compat_r; [lra|]. lra. }
        lra.
      * unfold Rdiv. rewrite <- !Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|].
        unfold b2. assert (0 <= S * (S - 1)) by nra.
        assert (S * S * L <= S * S * L * A).
        { rewrite <- (Rmult_1_r (S * S * L)) at 1. apply Rmult_le_compat_l; [nra|lra]. }
        replace (4 * (4 * S ^ 2 * A * L)) with (16 * (S * S * L * A)) by ring.
        assert (S - 1 <= 2 * (S - 1) * L) by nra. nra.
Qed.

End Stated.

Section Examples.

Let Phat (D : list (trajectory two two)) := count_estimate (St := two) (Ac := two) (fun s _ => dirac s) D.
Let clone := first_action (St := two) (Ac := two) false.

Example policy_error_as_stated_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    policy_error small 3 (deterministic keep) (deterministic (clone D))
    <= policy_error_stated (size two) (size two) 9 (/ 20)).
Proof. apply policy_error_as_stated; [apply first_action_clones|lia|lra]. Qed.

Example known_dynamics_as_stated_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    hellinger (trajectories 3) (trajectory_law small (deterministic keep))
      (trajectory_law small (deterministic (clone D)))
    <= offline_radius_known (size two) (size two) 9 (/ 20)).
Proof. apply known_dynamics_as_stated; [apply first_action_clones|lia|lra]. Qed.

Example tabular_confidence_set_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    distance_to_clone (markov fair (Phat D)) 3 (deterministic keep) (deterministic (clone D))
    <= offline_radius (size two) (size two) 3 9 (/ 20) (/ 4)).
Proof.
  apply tabular_confidence_set; try lia; try lra; [apply first_action_clones|].
  intros D _. apply count_estimate_is_likeliest.
Qed.

End Examples.
