(* The offline theorem: with
  probability at least 1 - delta over the demonstrations of a deterministic expert, the expert
   lies within the repaired radius of the clone, under the estimated kernel; the paper's theorem follows from it.

   The radii are the package's formulas, generated into Formulas.v. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet
  Bridge.Deterministic Bridge.Cloning.
Require Import Bridge.MaximumLikelihood Bridge.Covering Bridge.CountEstimate Bridge.Small.
Require Import Bridge.Arithmetic Bridge.Formulas.
Import ListNotations.
Open Scope R_scope.

(* A bound that holds for every k with probability c holds for the least of them. *)
Section Least.
Context {X : Type} (P : process X) (n : nat) (c : R) (error : list X -> R) (f : nat -> R).
Hypothesis each : forall k, (1 <= k)%nat -> with_probability P c n (fun h => error h <= f k).

Lemma some_below x : least_over_positive f < x -> exists k, (1 <= k)%nat /\ f k < x.
Proof.
  intros L. destruct (ClassicalDedekindReals.sig_forall_dec (fun k => x <= f (S k))) as [[k N]|A].
  - intros k. destruct (Rle_dec x (f (S k))); auto.
  - exists (S k). split; [lia|lra].
  - exfalso. assert (x <= least_over_positive f); [|lra].
    apply least_at_least. intros [|k] K; [lia|]. apply A.
Qed.

Lemma one_for_all (l : list (list X)) : exists k, (1 <= k)%nat
  /\ forall h, In h l -> error h <= f k -> error h <= least_over_positive f.
Proof.
  induction l as [|h l [k [K Q]]]; [exists 1%nat; split; [lia|intros ? []]|].
  destruct (Rle_lt_dec (error h) (least_over_positive f)) as [L|L].
  - exists k. split; auto. intros g [<-|I]; auto.
  - destruct (some_below (error h) L) as [j [J F]].
    destruct (Rle_lt_dec (f j) (f k)) as [M|M].
    + exists j. split; auto. intros g [<-|I] E; [lra|]. apply Q; auto. lra.
    + exists k. split; auto. intros g [<-|I] E; [lra|]. auto.
Qed.

Lemma with_probability_least : with_probability P c n (fun h => error h <= least_over_positive f).
Proof.
  destruct (one_for_all (histories (outcomes P) n)) as [k [K Q]].
  eapply with_probability_impl; [|apply (each k K)]. intros h I _ E. apply Q; auto.
Qed.

End Least.

Section Offline.
Context {St Ac : finite} (start : law St) (Pstar : St -> Ac -> law St) (expert : St -> Ac) (H n : nat).

Notation data := (list (trajectory St Ac)).
Notation truth := (markov start Pstar).
Notation demos := (demonstrations truth (deterministic expert) H).

(* The estimated kernel, as likely on the data as every kernel; the law of the first state is known. *)
Variable Phat : data -> St -> Ac -> law St.
Hypothesis Phat_likeliest : forall D, possible truth (deterministic expert) D -> likeliest_kernel D (Phat D).

Notation estimate D := (markov start (Phat D)).

(* A kernel all of whose rows are at most c times those of a cover, over the transitions of a trajectory. *)
Lemma law_dominated (P : St -> Ac -> law St) (Q : St -> law St) c t : 1 <= c ->
  (forall s s', P s (expert s) s' <= c * Q s s') ->
  trajectory_law (markov start P) (deterministic expert) t
  <= c ^ pred (length t) * trajectory_law (markov start (fun s _ => Q s)) (deterministic expert) t.
Proof.
  intros Pc L. unfold trajectory_law. induction t as [|[s a] t IH]; [simpl; lra|].
  cbn [prob step run]. unfold run_step; cbn [fst snd]. destruct t as [|[s0 a0] t].
  - simpl. lra.
  - set (past := (s0, a0) :: t) in *. cbn [markov]. change (pred (length ((s, a) :: past))) with (S (length t)).
    change (pred (length past)) with (length t) in IH.
    pose proof (prob_nonneg (run (markov start P) (deterministic expert)) past) as N1.
    pose proof (prob_nonneg (run (markov start (fun s _ => Q s)) (deterministic expert)) past) as N2.
    pose proof (mass_nonneg (deterministic expert past s) a) as N3.
    destruct (eqb a0 (expert s0)) eqn:Ea.
    + apply eqb_true in Ea. subst past. subst a0. cbn [markov].
      specialize (L s0 s). pose proof (mass_nonneg (P s0 (expert s0)) s). pose proof (mass_nonneg (Q s0) s).
      cbn [pow]. 
      replace (c * c ^ length t * (prob (run (markov start (fun s1 _ => Q s1)) (deterministic expert))
          ((s0, expert s0) :: t) * (Q s0 s * deterministic expert ((s0, expert s0) :: t) s a)))
        with ((c ^ length t * prob (run (markov start (fun s1 _ => Q s1)) (deterministic expert))
          ((s0, expert s0) :: t))
          * ((c * Q s0 s) * deterministic expert ((s0, expert s0) :: t) s a)) by ring.
      apply Rmult_le_compat; auto; [apply Rmult_le_pos; auto|]. apply Rmult_le_compat_r; auto.
    + assert (Z : forall E : environment St Ac, prob (run E (deterministic expert)) past = 0).
      { intros E. unfold past. cbn [prob step run]. unfold run_step; cbn [fst snd deterministic dirac mass].
        unfold dirac_mass. rewrite Ea. simpl. ring. }
      rewrite !Z. lra.
Qed.

Lemma some_state : exists s : St, True.
Proof. destruct (some_mass start) as [s _]. exists s. auto. Qed.

(* T6(ii) with T11: the error of the estimate on the expert's trajectories, for each denominator k of the lattice. *)
(* label: audit T6(ii) with T11 *)
Theorem transition_error_at k delta : (0 < n)%nat -> (0 < k)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    transition_error (estimate D) truth H (deterministic expert)
    <= 2 * INR (size St) / INR n * ln (C (k + 2 * size St - 2) (size St - 1))
       + 2 * INR H * ln (1 + (INR (size St) - 1) / INR k) + -2 * ln delta / INR n).
Proof.
  intros Pn Pk Pd. pose proof (lt_0_INR n Pn) as Pn'. pose proof (lt_0_INR k Pk) as Pk'.
  destruct some_state as [other _].
  destruct (lattice_covers_kernels (I := St) other k Pk) as [Num Cov].
  pose proof (size_positive other) as S0. apply le_INR in S0. simpl in S0.
  set (c := 1 + (INR (size St) - 1) / INR k).
  assert (Pc : 1 <= c).
  { unfold c, Rdiv. assert (0 <= (INR (size St) - 1) * / INR k); [|lra].
    apply Rmult_le_pos; [lra|]. left. apply Rinv_0_lt_compat; auto. }
  assert (Pr : 1 <= c ^ pred H) by (apply pow_R1_Rle; auto).
  assert (Nc : (0 < length (kernel_cover (I := St) other k))%nat).
  { destruct (Cov (fun s => Pstar s (expert s))) as [Q [I _]]. destruct (kernel_cover other k);
    [destruct I|simpl; lia]. }
  assert (PC : 0 < C (k + 2 * size St - 2) (size St - 1)).
  { unfold C, Rdiv. apply Rmult_lt_0_compat; [apply INR_fact_lt_0|].
    apply Rinv_0_lt_compat, Rmult_lt_0_compat; apply INR_fact_lt_0. }
  eapply with_probability_impl.
  2: { apply (cover_bound (trajectories H) (trajectory_law truth (deterministic expert)) n
      (trajectory_law_nonneg truth (deterministic expert)) (trajectory_law_total truth (deterministic expert) H)
      (kernel_cover (I := St) other k)
      (fun Q => trajectory_law (markov start (fun s _ => Q s)) (deterministic expert))
      (fun D => trajectory_law (estimate D) (deterministic expert)) (c ^ pred H)) with (delta := delta); auto.
    - intros; apply trajectory_law_nonneg.
    - intros; apply trajectory_law_total.
    - intros; apply trajectory_law_nonneg.
    - intros; apply trajectory_law_total.
    - intros D. destruct (Cov (fun s => Phat D s (expert s))) as [Q [I L]]. exists Q. split; auto.
      intros t J. pose proof (histories_length_list _ _ _ J) as <-. apply law_dominated; auto.
    - intros D L. apply likeliest_law. apply Phat_likeliest. apply (possible_data truth _ H D L). }
  intros D _ _ B. cbv beta in B. unfold transition_error. eapply Rle_trans; [exact B|].
  rewrite Num. unfold Rdiv. rewrite ln_mult; [|apply pow_lt; auto|apply Rinv_0_lt_compat; lra].
  rewrite ln_Rinv by lra. rewrite !ln_pow by (auto; lra).
  assert (INR (pred H) <= INR H) as Lh by (apply le_INR; lia).
  assert (0 <= ln c) as Lc.
  { rewrite <- ln_1. destruct Pc as [Pc|Pc]; [left; apply ln_increasing; lra|rewrite <- Pc; lra]. }
  fold c. assert (INR (pred H) * ln c <= INR H * ln c) by (apply Rmult_le_compat_r; auto).
  match goal with |- ?u + _ <= ?v + _ + ?w => assert (u = v + w) as Eu by (field; lra); rewrite Eu end. lra.
Qed.

(* The package's formula takes the least over k. *)
(* label: audit T6(ii) with T11 *)
Theorem transition_error_bound delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    transition_error (estimate D) truth H (deterministic expert)
    <= transition_error_repaired (size St) H n delta (size St)).
Proof.
  intros Pn Pd. destruct some_state as [other _]. pose proof (size_positive other) as S0.
  unfold transition_error_repaired, if_at_most. destruct (Rle_dec (INR (size St)) 1) as [L|L].
  - change 1 with (INR 1) in L. apply INR_le in L. assert (size St = 1%nat) as E1 by lia.
    eapply with_probability_impl; [|apply (transition_error_at 1 delta Pn); auto].
    intros D _ _ B. cbv beta in B. eapply Rle_trans; [exact B|]. rewrite E1.
    replace (1 + 2 * 1 - 2)%nat with 1%nat by lia. replace (1 - 1)%nat with 0%nat by lia. rewrite C_zero, ln_1.
    replace (1 + (INR 1 - 1) / INR 1) with 1 by (simpl; field). rewrite ln_1. lra.
  - set (f := fun k => 2 * INR (size St) / INR n * log_binomial (INR k + 2 * INR (size St) - 2) (INR (size St) - 1)
      + 2 * INR H * ln (1 + (INR (size St) - 1) / INR k)).
    eapply with_probability_impl; [|apply (with_probability_least demos n (1 - delta)
      (fun D => transition_error (estimate D) truth H (deterministic expert) - -2 * ln delta / INR n) f)].
    + intros D _ _ B. cbv beta in B. lra.
    + intros k K. eapply with_probability_impl; [|apply (transition_error_at k delta Pn K Pd)].
      intros D _ _ B. cbv beta in B. unfold f.
      replace (INR k + 2 * INR (size St) - 2) with (INR (k + 2 * size St - 2)).
      2: { rewrite minus_INR, plus_INR, mult_INR by lia. simpl. ring. }
      replace (INR (size St) - 1) with (INR (size St - 1)) by (rewrite minus_INR by lia; simpl; ring).
      rewrite log_binomial_INR. rewrite (minus_INR (size St) 1) by lia. simpl (INR 1). lra.
Qed.

Variable clone : data -> St -> Ac.
Hypothesis clone_maximises : clones truth expert clone.

Lemma policy_error_bound delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    policy_error truth H (deterministic expert) (deterministic (clone D)) <= policy_error_repaired (size St) n delta).
Proof.
  intros Pn Pd. eapply with_probability_impl; [|apply clone_error_bound; eauto].
  intros D _ _ B. cbv beta in B. eapply Rle_trans; [exact B|]. right. unfold policy_error_repaired.
  rewrite ln_Rinv by lra. pose proof (lt_0_INR n Pn). field. lra.
Qed.

Lemma two_bounds (R1 R2 delta : R) :
  with_probability demos (1 - delta / 2) n (fun D =>
    policy_error truth H (deterministic expert) (deterministic (clone D)) <= R1) ->
  with_probability demos (1 - delta / 2) n (fun D =>
    transition_error (estimate D) truth H (deterministic expert) <= R2) ->
  with_probability demos (1 - delta) n (fun D =>
    distance_to_clone (estimate D) H (deterministic expert) (deterministic (clone D)) <= sqrt R1 + sqrt (2 * R2)).
Proof.
  intros A B. replace (1 - delta) with (1 - delta / 2 - delta / 2) by field.
  eapply with_probability_impl; [|apply (with_probability_and demos (delta / 2) (delta / 2) n _ _ A B)].
  intros D _ _ [L1 L2]. eapply Rle_trans; [apply confidence_set_deterministic with (Pstar := truth)|].
  pose proof (policy_error_nonneg truth H (deterministic expert) (deterministic (clone D))).
  pose proof (transition_error_nonneg (estimate D) truth H (deterministic expert)).
  apply Rplus_le_compat; apply sqrt_le_1_alt; lra.
Qed.

(* label: audit T9 with T7(b), T6(ii) and T11 *)
Theorem offline_theorem delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    distance_to_clone (estimate D) H (deterministic expert) (deterministic (clone D))
    <= offline_radius_repaired (size St) H n delta (size St)).
Proof.
  intros Pn Pd. apply two_bounds; [apply policy_error_bound|apply transition_error_bound]; auto; lra.
Qed.

End Offline.

(* The package's algorithms: the first recorded action, and the count estimate. *)
(* label: audit T9 with T7(b), T6(ii) and T11, for the package's algorithms *)
Theorem offline_theorem_counts {St Ac : finite} (start : law St) (Pstar : St -> Ac -> law St) (expert : St -> Ac)
  (H n : nat) (default_row : St -> Ac -> law St) (default_action : Ac) (delta : R) :
  (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability (demonstrations (markov start Pstar) (deterministic expert) H) (1 - delta) n (fun D =>
    distance_to_clone (markov start (count_estimate default_row D)) H
      (deterministic expert) (deterministic (first_action default_action D))
    <= offline_radius_repaired (size St) H n delta (size St)).
Proof.
  intros Pn Pd. apply (offline_theorem start Pstar expert H n (fun D => count_estimate default_row D)); auto.
  - intros D _. apply count_estimate_is_likeliest.
  - apply first_action_clones.
Qed.

Section Examples.

Let Phat (D : list (trajectory two two)) := count_estimate (St := two) (Ac := two) (fun s _ => dirac s) D.

Lemma Phat_likeliest D : possible small (deterministic keep) D -> likeliest_kernel D (Phat D).
Proof. intros _. apply count_estimate_is_likeliest. Qed.

Example transition_error_at_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    transition_error (markov fair (Phat D)) small 3 (deterministic keep)
    <= 2 * INR (size two) / INR 9 * ln (C (5 + 2 * size two - 2) (size two - 1))
       + 2 * INR 3 * ln (1 + (INR (size two) - 1) / INR 5) + -2 * ln (/ 20) / INR 9).
Proof. apply transition_error_at; [apply Phat_likeliest|lia|lia|lra]. Qed.

Example transition_error_bound_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    transition_error (markov fair (Phat D)) small 3 (deterministic keep)
    <= transition_error_repaired (size two) 3 9 (/ 20) (size two)).
Proof. apply transition_error_bound; [apply Phat_likeliest|lia|lra]. Qed.

Example offline_theorem_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    distance_to_clone (markov fair (Phat D)) 3 (deterministic keep)
      (deterministic (first_action (St := two) (Ac := two) false D))
    <= offline_radius_repaired (size two) 3 9 (/ 20) (size two)).
Proof. apply offline_theorem; [apply Phat_likeliest|apply first_action_clones|lia|lra]. Qed.

Example offline_theorem_counts_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 3) (1 - / 20) 9 (fun D =>
    distance_to_clone (markov fair (count_estimate wrong_kernel D)) 3 (deterministic keep)
      (deterministic (first_action (St := two) (Ac := two) false D))
    <= offline_radius_repaired (size two) 3 9 (/ 20) (size two)).
Proof. apply offline_theorem_counts; [lia|lra]. Qed.

End Examples.
