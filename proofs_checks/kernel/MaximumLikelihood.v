(* Maximum likelihood over a finite class and over a logarithmic cover (the audit's T6). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Likelihood.
Context {X : Type} (points : list X) (p : X -> R) (n : nat).
Hypothesis p_nonneg : forall x, 0 <= p x.
Hypothesis p_total : sum p points = 1.

Notation draws := (independent points p p_nonneg p_total).

Definition ratio (rho : R) (g : X -> R) (x : X) : R := rho * sqrt (g x / p x).
Definition reaches_one (f : X -> R) (D : list X) : bool := if Rle_dec 1 (product f D) then true else false.

Lemma possible_draws D : 0 < prob draws D -> forall x, In x D -> 0 < p x.
Proof.
  rewrite prob_independent. induction D as [|y D IH]; intros L x []; cbn [product] in L.
  - subst. destruct (p_nonneg x) as [Q|Q]; auto. rewrite <- Q in L. lra.
  - apply IH; auto. pose proof (product_nonneg p D (fun z _ => p_nonneg z)) as N. pose proof (p_nonneg y).
    destruct N as [N|N]; auto. rewrite <- N in L. lra.
Qed.

(* Chernoff's argument with exponent 1/2. *)
Lemma ratio_tail rho g : 0 <= rho -> (forall x, 0 <= g x) ->
  Pr draws n (reaches_one (ratio rho g)) <= (rho * overlap points p g) ^ n.
Proof.
  intros Pr0 Pg. apply Rle_trans with (expect draws n (product (ratio rho g))).
  - rewrite <- (Rmult_1_l (Pr draws n _)). apply markov_inequality. intros D _ _. apply product_nonneg. intros.
    apply Rmult_le_pos; auto. apply sqrt_pos.
  - rewrite expect_product. apply pow_incr. split.
    + apply sum_nonneg. intros. apply Rmult_le_pos; auto. apply Rmult_le_pos; auto. apply sqrt_pos.
    + unfold overlap. rewrite <- sum_scal. apply sum_le. intros x _. unfold ratio.
      replace (p x * (rho * sqrt (g x / p x))) with (rho * (p x * sqrt (g x / p x))) by ring.
      apply Rmult_le_compat_l; auto. destruct (p_nonneg x) as [L|Z].
      * rewrite <- (sqrt_square (p x)) at 1 by auto. rewrite <- root_mult.
        -- right. f_equal. field. lra.
        -- apply Rmult_le_pos; auto.
        -- unfold Rdiv. apply Rmult_le_pos; auto. left. apply Rinv_0_lt_compat; auto.
      * rewrite <- Z, !Rmult_0_l, sqrt_0. lra.
Qed.

(* Data under which g' times rho^2 dominates a law that is as likely as the truth. *)
Lemma ratio_reaches_one rho g D : 0 <= rho -> 0 < prob draws D -> (forall x, 0 <= g x) ->
  product p D <= product (fun x => rho * rho * g x) D -> reaches_one (ratio rho g) D = true.
Proof.
  intros Pr0 L Pg Q. unfold reaches_one. destruct (Rle_dec 1 (product (ratio rho g) D)) as [|N]; auto. exfalso.
  apply N. clear N. apply square_le.
  - apply product_nonneg. intros. apply Rmult_le_pos; auto. apply sqrt_pos.
  - rewrite Rmult_1_l, <- product_mult.
    assert (Pp : 0 < product p D) by (apply product_pos, possible_draws; auto).
    apply Rmult_le_reg_l with (product p D); auto. rewrite Rmult_1_r, <- product_mult.
    eapply Rle_trans; [exact Q|]. right. apply product_ext. intros x I.
    pose proof (possible_draws D L x I) as Px. unfold ratio.
    replace (rho * sqrt (g x / p x) * (rho * sqrt (g x / p x)))
      with (rho * rho * (sqrt (g x / p x) * sqrt (g x / p x))) by ring.
    rewrite sqrt_sqrt; [field; lra|]. unfold Rdiv. apply Rmult_le_pos; auto. left. apply Rinv_0_lt_compat; auto.
Qed.

Lemma filter_no_longer {A : Type} (b : A -> bool) (l : list A) : (length (filter b l) <= length l)%nat.
Proof. induction l as [|x l IH]; simpl; [lia|]. destruct (b x); simpl; lia. Qed.

Lemma filter_shorter {A : Type} (b : A -> bool) (l : list A) x : In x l -> b x = false ->
  INR (length (filter b l)) <= INR (length l) - 1.
Proof.
  intros I F. assert (length (filter b l) < length l)%nat as L.
  - induction l as [|y l IH]; [destruct I|]. simpl. destruct I as [->|I].
    + rewrite F. pose proof (filter_no_longer b l). lia.
    + specialize (IH I). destruct (b y); simpl; lia.
  - apply le_INR in L. rewrite S_INR in L. lra.
Qed.

(* T6(i): a finite class with the truth in it; the estimate is any element at least as likely as the truth. *)
Section FiniteClass.
Context {K : Type} (class : list K) (member : K -> X -> R) (truth : K) (estimate : list X -> K).
Hypothesis member_nonneg : forall k x, 0 <= member k x.
Hypothesis member_total : forall k, sum (member k) points = 1.
Hypothesis truth_in : In truth class.
Hypothesis truth_is : forall x, member truth x = p x.
Hypothesis estimate_in : forall D, In (estimate D) class.
Hypothesis likeliest : forall D, 0 < prob draws D -> product p D <= product (member (estimate D)) D.

Lemma finite_class_tail r : 0 <= r <= 1 ->
  with_probability draws (1 - (INR (length class) - 1) * (1 - r) ^ n) n
    (fun D => hellinger2 points (member (estimate D)) p <= r).
Proof.
  intros Pr0. set (far := fun k => if Rle_dec (hellinger2 points (member k) p) r then false else true).
  apply with_probability_not with
    (b := fun D => existsb (fun k => reaches_one (ratio 1 (member k)) D) (filter far class)).
  - eapply Rle_trans; [apply Pr_union|].
    apply Rle_trans with (sum (fun _ => (1 - r) ^ n) (filter far class)).
    + apply sum_le. intros k I. apply filter_In in I. destruct I as [_ F]. unfold far in F.
      destruct (Rle_dec _ r) as [|L]; [discriminate|]. eapply Rle_trans; [apply ratio_tail; auto; lra|].
      rewrite Rmult_1_l. apply pow_incr. split; [apply overlap_nonneg|].
      rewrite hellinger2_sym in L. unfold hellinger2 in L. lra.
    + rewrite sum_const. apply Rmult_le_compat_r; [apply pow_le; lra|].
      apply filter_shorter with truth; auto. unfold far.
      destruct (Rle_dec (hellinger2 points (member truth) p) r) as [|L]; auto. exfalso. apply L.
      unfold hellinger2. replace (overlap points (member truth) p) with (sum p points); [lra|].
      apply sum_ext. intros x _. rewrite truth_is. symmetry. apply sqrt_square; auto.
  - intros D _ L F. destruct (Rle_lt_dec (hellinger2 points (member (estimate D)) p) r) as [|Q]; auto. exfalso.
    assert (existsb (fun k => reaches_one (ratio 1 (member k)) D) (filter far class) = true); [|congruence].
    apply existsb_exists. exists (estimate D). split.
    + apply filter_In. split; auto. unfold far. destruct (Rle_dec _ r); auto. lra.
    + apply ratio_reaches_one; auto; try lra. eapply Rle_trans; [apply likeliest; auto|]. right.
      apply product_ext. intros; ring.
Qed.

Lemma finite_class_bound delta : (0 < n)%nat -> (2 <= length class)%nat -> 0 < delta <= 1 ->
  with_probability draws (1 - delta) n
    (fun D => hellinger2 points (member (estimate D)) p <= ln ((INR (length class) - 1) / delta) / INR n).
Proof.
  intros Pn Pk Pd. pose proof (lt_0_INR n Pn) as Pn'. apply le_INR in Pk. simpl in Pk.
  set (N := INR (length class) - 1). assert (PN : 1 <= N) by (unfold N; lra).
  set (r := ln (N / delta) / INR n).
  assert (Q : 1 <= N / delta).
  { apply Rmult_le_reg_r with delta; [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  assert (Pr0 : 0 <= r).
  { unfold r, Rdiv. apply Rmult_le_pos; [|left; apply Rinv_0_lt_compat; auto].
    rewrite <- ln_1. destruct Q as [Q|Q]; [left; apply ln_increasing; unfold Rdiv in *;
      lra|]. right. f_equal. exact Q. }
  destruct (Rle_lt_dec r 1) as [R1|R1].
  - apply with_probability_weaken with (1 - N * (1 - r) ^ n); [|apply finite_class_tail; lra].
    assert ((1 - r) ^ n <= exp (- (INR n * r))) as L.
    { replace (exp (- (INR n * r))) with (exp (- r) ^ n).
      - apply pow_incr. split; [lra|]. pose proof (one_plus_le_exp (- r)). lra.
      - rewrite <- Rpower_pow by apply exp_pos. unfold Rpower. rewrite ln_exp. f_equal. ring. }
    assert (exp (- (INR n * r)) = delta / N) as Er.
    { unfold r. replace (INR n * (ln (N / delta) / INR n)) with (ln (N / delta)) by (field; lra).
      rewrite exp_Ropp, exp_ln by lra. field. lra. }
    rewrite Er in L. assert (N * (1 - r) ^ n <= N * (delta / N)) as M by (apply Rmult_le_compat_l; lra).
    replace (N * (delta / N)) with delta in M by (field; lra). lra.
  - apply with_probability_weaken with 1; [lra|]. apply surely. intros D _ _.
    pose proof (hellinger2_range points (member (estimate D)) p (member_nonneg _) p_nonneg (member_total _) p_total).
    lra.
Qed.

End FiniteClass.

(* T6(ii): an infinite class with a cover: every estimate is at most r times an element of it. *)
Section Cover.
Context {K : Type} (cover : list K) (element : K -> X -> R) (estimate : list X -> X -> R) (r : R).
Hypothesis r_at_least_one : 1 <= r.
Hypothesis cover_not_empty : (0 < length cover)%nat.
Hypothesis element_nonneg : forall k x, 0 <= element k x.
Hypothesis element_total : forall k, sum (element k) points = 1.
Hypothesis estimate_nonneg : forall D x, 0 <= estimate D x.
Hypothesis estimate_total : forall D, sum (estimate D) points = 1.
Hypothesis covered : forall D, exists k, In k cover /\ forall x, In x points -> estimate D x <= r * element k x.
Hypothesis likeliest : forall D, 0 < prob draws D -> product p D <= product (estimate D) D.

Lemma near_its_element D k : (forall x, In x points -> estimate D x <= r * element k x) ->
  hellinger2 points (estimate D) (element k) <= ln r / 2.
Proof.
  intros Q. assert (Pr0 : 0 < sqrt r) by (apply sqrt_lt_R0; lra).
  assert (/ sqrt r <= overlap points (estimate D) (element k)) as O.
  { rewrite <- (Rmult_1_r (/ sqrt r)), <- (estimate_total D). rewrite <- sum_scal. apply sum_le. intros x I.
    apply Rmult_le_reg_l with (sqrt r); auto. rewrite <- Rmult_assoc, Rinv_r, Rmult_1_l by lra.
    rewrite <- root_mult; [|lra|apply Rmult_le_pos; auto].
    rewrite <- (sqrt_square (estimate D x)) at 1 by auto. apply sqrt_le_1_alt.
    replace (r * (estimate D x * element k x)) with (estimate D x * (r * element k x)) by ring.
    apply Rmult_le_compat_l; auto. }
  assert (1 - / sqrt r <= ln r / 2); [|unfold hellinger2; lra].
  pose proof (ln_le_minus_one (/ sqrt r) (Rinv_0_lt_compat _ Pr0)) as L. rewrite ln_Rinv in L by auto.
  assert (ln r = 2 * ln (sqrt r)) as E; [|lra].
  rewrite <- (sqrt_sqrt r) at 1 by lra. rewrite ln_mult by auto. ring.
Qed.

Lemma doubled (D : list X) k :
  hellinger2 points (estimate D) p
  <= 2 * hellinger2 points (estimate D) (element k) + 2 * hellinger2 points (element k) p.
Proof.
  rewrite !hellinger2_roots; auto.
  replace (2 * (/ 2 * sum (fun x => (sqrt (estimate D x) - sqrt (element k x)) * (sqrt (estimate D x) - sqrt
    (element k x)))
      points) + 2 * (/ 2 * sum (fun x => (sqrt (element k x) - sqrt (p x)) * (sqrt (element k x) - sqrt
        (p x))) points))
    with (/ 2 * sum (fun x => 2 * ((sqrt (estimate D x) - sqrt (element k x)) * (sqrt (estimate D x) - sqrt
      (element k x)))
      + 2 * ((sqrt (element k x) - sqrt (p x)) * (sqrt (element k x) - sqrt (p x)))) points).
  - apply Rmult_le_compat_l; [lra|]. apply sum_le. intros x _.
    pose proof (square_nonneg (sqrt (estimate D x) - sqrt (element k x) - (sqrt (element k x) - sqrt (p x)))). nra.
  - rewrite sum_plus, !sum_scal. lra.
Qed.

Lemma cover_bound delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability draws (1 - delta) n (fun D =>
    hellinger2 points (estimate D) p <= 2 * ln (INR (length cover) / delta) / INR n + 2 * ln r).
Proof.
  intros Pn Pd. pose proof (lt_0_INR n Pn) as Pn'. pose proof (lt_0_INR _ cover_not_empty) as PN.
  set (N := INR (length cover)) in *. set (a := ln (N / delta) / INR n).
  assert (Pr0 : 0 < sqrt r) by (apply sqrt_lt_R0; lra).
  assert (QN : 0 < N / delta) by (unfold Rdiv; apply Rmult_lt_0_compat; [auto|apply Rinv_0_lt_compat; lra]).
  set (far := fun k => if Rle_dec (exp (- a)) (sqrt r * overlap points p (element k)) then false else true).
  apply with_probability_not with
    (b := fun D => existsb (fun k => reaches_one (ratio (sqrt r) (element k)) D) (filter far cover)).
  - eapply Rle_trans; [apply Pr_union|].
    apply Rle_trans with (sum (fun _ => delta / N) (filter far cover)).
    + apply sum_le. intros k I. apply filter_In in I. destruct I as [_ F]. unfold far in F.
      destruct (Rle_dec _ _) as [|L]; [discriminate|]. eapply Rle_trans; [apply ratio_tail; auto; lra|].
      replace (delta / N) with (exp (- a) ^ n).
      * apply pow_incr. split; [apply Rmult_le_pos; [lra|apply overlap_nonneg]|lra].
      * rewrite <- Rpower_pow by apply exp_pos. unfold Rpower. rewrite ln_exp.
        replace (INR n * - a) with (- ln (N / delta)) by (unfold a; field; lra).
        rewrite exp_Ropp, exp_ln by auto. field. lra.
    + rewrite sum_const. apply Rle_trans with (N * (delta / N)); [|right; field; lra].
      apply Rmult_le_compat_r; [left; unfold Rdiv; apply Rmult_lt_0_compat; [lra|apply Rinv_0_lt_compat; auto]|].
      apply le_INR, filter_no_longer.
  - intros D ID L F. destruct (covered D) as [k [I Q]].
    pose proof (near_its_element D k Q) as Near. pose proof (doubled D k) as Two.
    assert (hellinger2 points (element k) p <= a + ln r / 2) as Far.
    2: { unfold a in Far. replace (2 * ln (N / delta) / INR n) with (2 * (ln (N / delta) / INR n)) by (field;
      lra). lra. }
    destruct (far k) eqn:Fk.
    + exfalso. assert (existsb (fun k => reaches_one (ratio (sqrt r) (element k)) D) (filter far cover) = true);
        [|congruence].
      apply existsb_exists. exists k. split; [apply filter_In; auto|]. apply ratio_reaches_one; auto; try lra.
      eapply Rle_trans; [apply likeliest; auto|]. apply product_le. intros x J. split; auto.
      rewrite sqrt_sqrt by lra. apply Q, (histories_outcomes draws n D x ID J).
    + unfold far in Fk. destruct (Rle_dec _ _) as [G|]; [|discriminate].
      pose proof (exp_pos (- a)) as Pa. pose proof (overlap_nonneg points p (element k)) as Po.
      set (o := overlap points p (element k)) in *.
      assert (0 < o) as Po'.
      { destruct Po as [Po|Po]; auto. rewrite <- Po in G. lra. }
      rewrite hellinger2_sym. unfold hellinger2. fold o.
      assert (- a <= ln (sqrt r) + ln o) as Ll.
      { rewrite <- ln_mult by auto. rewrite <- (ln_exp (- a)).
        destruct G as [G|G]; [left; apply ln_increasing; auto|rewrite G; lra]. }
      pose proof (ln_le_minus_one o Po').
      assert (ln r = 2 * ln (sqrt r)) as E; [|lra].
      rewrite <- (sqrt_sqrt r) at 1 by lra. rewrite ln_mult by auto. ring.
Qed.

End Cover.
End Likelihood.

(* The finite class of policies: cloning by maximum likelihood, ties broken in any way. *)
Section Policies.
Context {St Ac : finite} (E : environment St Ac) (H n : nat) (class : list (policy St Ac)) (expert : policy St Ac).
Variable clone : list (trajectory St Ac) -> policy St Ac.
Hypothesis expert_in : In expert class.
Hypothesis clone_in : forall D, In (clone D) class.
Hypothesis clone_likeliest : forall D, possible E expert D ->
  product (policy_factor expert) D <= product (policy_factor (clone D)) D.

Lemma clone_law_likeliest D : 0 < prob (demonstrations E expert H) D ->
  product (trajectory_law E expert) D <= product (trajectory_law E (clone D)) D.
Proof.
  intros L. pose proof (clone_likeliest D (possible_data E expert H D L)) as Q.
  rewrite !(product_ext (trajectory_law E _) (fun t => dynamics_factor E t * policy_factor _ t))
    by (intros; apply factorisation).
  rewrite !product_mult. apply Rmult_le_compat_l; auto. apply product_nonneg. intros. apply dynamics_factor_nonneg.
Qed.

(* label: audit T6(i) *)
Theorem finite_class_of_policies delta : (0 < n)%nat -> (2 <= length class)%nat -> 0 < delta <= 1 ->
  with_probability (demonstrations E expert H) (1 - delta) n (fun D =>
    policy_error E H expert (clone D) <= ln ((INR (length class) - 1) / delta) / INR n).
Proof.
  intros Pn Pk Pd.
  apply (finite_class_bound (trajectories H) (trajectory_law E expert) n (trajectory_law_nonneg E expert)
    (trajectory_law_total E expert H) class (trajectory_law E) expert clone); auto.
  - intros. apply trajectory_law_nonneg.
  - intros. apply trajectory_law_total.
  - apply clone_law_likeliest.
Qed.

(* The paper's constants. *)
(* label: thm:generalization_bound_logloss_BC_general, finite class *)
Theorem finite_class_of_policies_stated delta : (0 < n)%nat -> (2 <= length class)%nat -> 0 < delta <= 1 ->
  with_probability (demonstrations E expert H) (1 - delta) n (fun D =>
    policy_error E H expert (clone D) <= 6 * ln (2 * INR (length class) / delta) / INR n).
Proof.
  intros Pn Pk Pd. eapply with_probability_impl; [|apply finite_class_of_policies; eauto].
  intros D _ _ Q. cbv beta in Q. eapply Rle_trans; [exact Q|]. pose proof (lt_0_INR n Pn) as Pn'.
  apply le_INR in Pk. simpl in Pk. set (N := INR (length class)) in *.
  unfold Rdiv. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|].
  assert (0 < / delta) as Pi by (apply Rinv_0_lt_compat; lra).
  assert (ln ((N - 1) * / delta) <= ln (2 * N * / delta)) as L1.
  { left. apply ln_increasing; [apply Rmult_lt_0_compat; lra|]. apply Rmult_lt_compat_r; lra. }
  assert (1 <= / delta) as Pi1.
  { rewrite <- Rinv_1. apply Rinv_le_contravar; lra. }
  assert (0 <= ln (2 * N * / delta)) as L2.
  { rewrite <- ln_1. left. apply ln_increasing; [lra|]. nra. }
  lra.
Qed.

End Policies.

(* Two policies, one of them the expert; the clone takes the other one where it never contradicts the data. *)
Section Examples.

Let class : list (policy two two) := [deterministic keep; deterministic stay_in_first].

Let clone (D : list (trajectory two two)) : policy two two :=
  if forallb (follows stay_in_first) D then deterministic stay_in_first else deterministic keep.

Lemma clone_is_likeliest D : possible small (deterministic keep) D ->
  product (policy_factor (deterministic keep)) D <= product (policy_factor (clone D)) D.
Proof.
  intros _. unfold clone. destruct (forallb (follows stay_in_first) D) eqn:F; [|lra].
  apply product_le. intros t I. rewrite !deterministic_factor. rewrite forallb_forall in F. rewrite (F t I).
  apply indicator_range.
Qed.

Lemma clone_in_class D : In (clone D) class.
Proof. unfold clone, class. destruct (forallb _ D); simpl; auto. Qed.

Example finite_class_of_policies_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - / 20) 9 (fun D =>
    policy_error small 2 (deterministic keep) (clone D) <= ln ((INR (length class) - 1) / / 20) / INR 9).
Proof.
  apply finite_class_of_policies; try lra; try (simpl; lia).
  - simpl; auto.
  - apply clone_in_class.
  - apply clone_is_likeliest.
Qed.

Example finite_class_of_policies_stated_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - / 20) 9 (fun D =>
    policy_error small 2 (deterministic keep) (clone D) <= 6 * ln (2 * INR (length class) / / 20) / INR 9).
Proof.
  apply finite_class_of_policies_stated; try lra; try (simpl; lia).
  - simpl; auto.
  - apply clone_in_class.
  - apply clone_is_likeliest.
Qed.

End Examples.
