(* Certified answers, from the decision process to the sentence: demonstrations leave a set of policies, a session of
   questions leaves a set of weights, and a recommendation that the certificate accepts is within eps of the best. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Logistic Bridge.Sessions Bridge.Certificates Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section CertifiedAnswers.
Context {St Ac : finite} (E : environment St Ac) (H d : nat).
Variable feature : trajectory St Ac -> vector.

(* Questions show two trajectories of H states; they may be chosen in any way. *)
Definition question : Type := (trajectory St Ac * trajectory St Ac).
Definition questions : list question := list_prod (trajectories H) (trajectories H).
Definition difference (q : question) : vector := minus (feature (fst q)) (feature (snd q)).

(* The expected features of a policy, and its utility: the teacher's judgement of its trajectories, on average. *)
Definition expected_feature (pi : policy St Ac) : vector := fun i => mean E pi H (fun t => feature t i).

Definition value (w : vector) (pi : policy St Ac) : R := mean E pi H (fun t => dot d (feature t) w).

Lemma utility_is_value w pi : utility d expected_feature w pi = value w pi.
Proof.
  unfold utility, value, dot, expected_feature, mean. rewrite (expect_sum _ _ (fun i t => feature t i * w i)).
  apply sum_ext. intros i _. rewrite Rmult_comm, <- expect_scal. apply expect_ext. intros; ring.
Qed.

(* Weights from a convex set with support function s, fixed beforehand; the teacher's are among them. *)
Variables (weights : vector -> Prop) (s : vector -> R) (wstar : vector).
Hypothesis support : supports d s weights.
Hypothesis wstar_in : weights wstar.

(* Candidates, and a demonstrator that is best among them for the teacher's weights. *)
Variables (candidates : list (policy St Ac)) (pistar : policy St Ac).
Hypothesis pistar_best : forall pi, In pi candidates -> value wstar pi <= value wstar pistar.

(* What n demonstrations leave of the candidates; it loses the demonstrator with probability delta_off at most. *)
Variables (n : nat) (remaining : list (trajectory St Ac) -> list (policy St Ac)) (delta_off delta : R).
Hypothesis delta_off_nonneg : 0 <= delta_off.
Hypothesis delta_range : 0 < delta <= 1.
Hypothesis remains :
  with_probability (demonstrations E pistar H) (1 - delta_off) n (fun D => In pistar (remaining D)).

(* After the demonstrations, and before the first answer: who asks, and forecasters with their prior weights. *)
Context {K : Type} (A : list (trajectory St Ac) -> asker question questions).
Variables (forecasters : list (trajectory St Ac) -> list K) (nu : list (trajectory St Ac) -> K -> R).
Variable f : list (trajectory St Ac) -> K -> forecast (Q := question).
Hypothesis nu_nonneg : forall D k, In k (forecasters D) -> 0 <= nu D k.
Hypothesis nu_total : forall D, sum (nu D) (forecasters D) = 1.
Hypothesis f_honest : forall D k, In k (forecasters D) -> honest (f D k).

(* The level of the set of plausible weights: any number whose exponential is at most delta times the mixture. *)
Definition valid_level (D : list (trajectory St Ac)) (h : list (question * answer)) (level : R) : Prop :=
  exp level <= delta * mixture (forecasters D) (nu D) (f D) h.

Definition in_session (m : nat) :=
  with_probability_both (demonstrations E pistar H) (fun D => session questions d difference wstar (A D)) n m.

Lemma truth_remains m :
  in_session m (1 - delta_off - delta) (fun D => always (fun h =>
    In pistar (remaining D) /\ forall level, valid_level D h level -> plausible d difference weights level h wstar)).
Proof.
  apply in_two_stages with (A := fun D => In pistar (remaining D)); auto; try lra.
  - apply list_eq_dec, trajectory_same.
  - intros D _ _ I.
    apply with_probability_impl with (A := always (fun h =>
      delta * mixture (forecasters D) (nu D) (f D) h < likelihood d difference wstar h)).
    + intros h _ _. apply always_impl. intros g L. split; auto. intros level V. split; auto.
      unfold valid_level in V. unfold log_likelihood. rewrite <- (ln_exp level). left.
      apply ln_increasing; [apply exp_pos|lra].
    + apply likelihood_set_covers; auto; lra.
Qed.

Lemma best_utility : best d candidates expected_feature wstar pistar.
Proof. intros pi I. rewrite !utility_is_value. auto. Qed.

(* The certificate for a recommendation after history h. *)
Definition accepts (D : list (trajectory St Ac)) (h : list (question * answer)) (level : R)
  (direction : policy St Ac -> vector) (eps : R) : Prop :=
  valid_level D h level
  /\ certified d difference s candidates expected_feature level h (remaining D) direction eps.

(* label: companion G3 *)
Theorem certified_answers m :
  in_session m (1 - delta_off - delta) (fun D => always (fun h =>
    forall level recommended eps,
      accepts D h level (fun pi => minus (expected_feature pi) (expected_feature recommended)) eps ->
      value wstar pistar - value wstar recommended <= eps)).
Proof.
  destruct (truth_remains m) as [b [L B]]. exists b. split; auto.
  intros D h I J K0 K1 T. specialize (B D h I J K0 K1 T). revert B. apply always_impl.
  intros g [R0 P] level recommended eps [V Z]. rewrite <- !utility_is_value.
  apply (certified_gap d difference weights s support candidates expected_feature wstar level g (remaining D)); auto.
  apply best_utility.
Qed.

(* label: companion G3' *)
Theorem certified_share_of_gain m :
  in_session m (1 - delta_off - delta) (fun D => always (fun h =>
    forall level recommended reference rho, 0 < rho ->
      accepts D h level (share_direction expected_feature recommended reference rho) 0 ->
      / (1 + rho) * (value wstar pistar - value wstar reference) <= value wstar recommended - value wstar reference)).
Proof.
  destruct (truth_remains m) as [b [L B]]. exists b. split; auto.
  intros D h I J K0 K1 T. specialize (B D h I J K0 K1 T). revert B. apply always_impl.
  intros g [R0 P] level recommended reference rho Pr [V Z]. rewrite <- !utility_is_value.
  apply (certified_share d difference weights s support candidates expected_feature wstar level g
    (remaining D)); auto.
  apply best_utility.
Qed.

End CertifiedAnswers.

(* The version space of a deterministic demonstrator: the candidates that took every recorded action. *)
Section VersionSpace.
Context {St Ac : finite}.

Definition consistent (D : list (trajectory St Ac)) (g : St -> Ac) : bool := forallb (follows g) D.

Definition version_space (candidates : list (St -> Ac)) (D : list (trajectory St Ac)) : list (policy St Ac) :=
  map deterministic (filter (consistent D) candidates).

Lemma expert_stays (E : environment St Ac) H n (expert : St -> Ac) candidates : In expert candidates ->
  with_probability (demonstrations E (deterministic expert) H) (1 - 0) n
    (fun D => In (deterministic expert) (version_space candidates D)).
Proof.
  intros I. rewrite Rminus_0_r. apply surely. intros D _ L. apply in_map, filter_In. split; auto.
  apply forallb_forall. intros t J. apply possible_follows with E.
  apply (possible_data E (deterministic expert) H D L t J).
Qed.

(* With a deterministic demonstrator among the candidates nothing is lost before the session. *)
(* label: companion G3 *)
Theorem certified_answers_version_space
  (E : environment St Ac) (H d : nat) (feature : trajectory St Ac -> vector)
  (weights : vector -> Prop) (s : vector -> R) (wstar : vector)
  (candidates : list (St -> Ac)) (expert : St -> Ac) (n m : nat) (delta : R)
  (K : Type) (A : list (trajectory St Ac) ->
    asker question (questions H)) (forecasters : list (trajectory St Ac) -> list K)
  (nu : list (trajectory St Ac) -> K -> R) (f : list (trajectory St Ac) -> K -> forecast) :
  supports d s weights -> weights wstar -> In expert candidates ->
  (forall g, In g candidates ->
     value E H d feature wstar (deterministic g) <= value E H d feature wstar (deterministic expert)) ->
  0 < delta <= 1 ->
  (forall D k, In k (forecasters D) -> 0 <= nu D k) -> (forall D, sum (nu D) (forecasters D) = 1) ->
  (forall D k, In k (forecasters D) -> honest (f D k)) ->
  in_session E H d feature wstar (deterministic expert) n A m (1 - delta) (fun D => always (fun h =>
    forall level recommended eps,
      accepts E H d feature s (map deterministic candidates)
        (version_space candidates) delta forecasters nu f D h level
        (fun pi => minus (expected_feature E H feature pi) (expected_feature E H feature recommended)) eps ->
      value E H d feature wstar (deterministic expert) - value E H d feature wstar recommended <= eps)).
Proof.
  intros Hs Hw I B Pd N T O. replace (1 - delta) with (1 - 0 - delta) by ring.
  apply certified_answers with (weights := weights); auto; try lra.
  - intros pi J. apply in_map_iff in J. destruct J as [g [<- J]]. auto.
  - apply expert_stays; auto.
Qed.

End VersionSpace.

(* The premises are met: the small process, its expert, a uniform asker, even odds against a bold forecaster. *)
Section Example.

Lemma many_questions : (0 < length (questions (St := two) (Ac := two) 1))%nat.
Proof. simpl. lia. Qed.

Definition uniform_asker : asker (question (St := two) (Ac := two)) (questions 1).
Proof.
  refine (Asker _ _ (fun _ _ => / INR (length (questions 1))) _ _ (fun _ _ => / 4) _).
  - intros _ _. left. apply Rinv_0_lt_compat, lt_0_INR, many_questions.
  - intros _. rewrite sum_const. apply Rinv_r. apply not_0_INR. pose proof many_questions. lia.
  - intros; lra.
Defined.

Let w : vector := one_dimension.

Lemma value_keep : value small 1 1 last_action w (deterministic keep) = 1.
Proof.
  unfold value, mean. rewrite <- (expect_const (run small (deterministic keep)) 1 1). apply expect_ext.
  intros t I L. pose proof (possible_follows small keep t L) as Ft. apply histories_length in I.
  destruct t as [|[s a] t]; [discriminate|]. rewrite (follows_pair keep ((s, a) :: t) s a Ft) by (simpl; auto).
  unfold dot, last_action, w, one_dimension, keep; simpl. ring.
Qed.

Lemma value_at_most pi : value small 1 1 last_action w pi <= 1.
Proof.
  unfold value, mean. rewrite <- (expect_const (run small pi) 1 1). apply expect_le.
  intros [|[s a] t] _ _; unfold dot, last_action, w, one_dimension; simpl; [lra|].
  destruct a; simpl; lra.
Qed.

Let accepted := accepts small 1 1 last_action (fun u => 1 * norm 1 u) (map deterministic [keep; stay_in_first])
  (version_space [keep; stay_in_first]) (/ 20) (fun _ => [true; false]) (fun _ _ => / 2)
  (fun _ k => if k : bool then even_odds else bold).

Example certified_answers_version_space_nonvacuous :
  in_session small 1 1 last_action w (deterministic keep) 3 (fun _ => uniform_asker) 10 (1 - / 20)
    (fun D => always (fun h => forall level recommended eps,
      accepted D h level
        (fun pi => minus (expected_feature small 1 last_action pi)
          (expected_feature small 1 last_action recommended)) eps ->
      value small 1 1 last_action w (deterministic keep) - value small 1 1 last_action w recommended <= eps)).
Proof.
  apply certified_answers_version_space with (weights := ball 1 1); try lra.
  - apply ball_supports.
  - apply unit_weight.
  - simpl; auto.
  - intros g _. rewrite value_keep. apply value_at_most.
  - intros; lra.
  - intros; simpl; lra.
  - intros _ [] _; [apply even_odds_honest|apply bold_honest].
Qed.

Let always_remaining (_ : list (trajectory two two)) : list (policy two two) := [deterministic keep; random_policy].

Lemma keep_remains :
  with_probability (demonstrations small (deterministic keep) 1) (1 - / 10) 3
    (fun D => In (deterministic keep) (always_remaining D)).
Proof. apply with_probability_weaken with 1; [lra|]. apply surely. intros; simpl; auto. Qed.

Let accepted_all := accepts small 1 1 last_action (fun u => 1 * norm 1 u) [deterministic keep; random_policy]
  always_remaining (/ 20) (fun _ => [true; false]) (fun _ _ => / 2) (fun _ k => if k : bool then even_odds else bold).

Example certified_answers_nonvacuous :
  in_session small 1 1 last_action w (deterministic keep) 3 (fun _ => uniform_asker) 10 (1 - / 10 - / 20)
    (fun D => always (fun h => forall level recommended eps,
      accepted_all D h level
        (fun pi => minus (expected_feature small 1 last_action pi)
          (expected_feature small 1 last_action recommended)) eps ->
      value small 1 1 last_action w (deterministic keep) - value small 1 1 last_action w recommended <= eps)).
Proof.
  apply certified_answers with (weights := ball 1 1); try lra.
  - apply ball_supports.
  - apply unit_weight.
  - intros pi _. rewrite value_keep. apply value_at_most.
  - apply keep_remains.
  - intros; lra.
  - intros; simpl; lra.
  - intros _ [] _; [apply even_odds_honest|apply bold_honest].
Qed.

Example certified_share_of_gain_nonvacuous :
  in_session small 1 1 last_action w (deterministic keep) 3 (fun _ => uniform_asker) 10 (1 - / 10 - / 20)
    (fun D => always (fun h => forall level recommended reference rho, 0 < rho ->
      accepted_all D h level (share_direction (expected_feature small 1 last_action) recommended reference rho) 0 ->
      / (1 + rho) * (value small 1 1 last_action w (deterministic keep) - value small 1 1 last_action w reference)
      <= value small 1 1 last_action w recommended - value small 1 1 last_action w reference)).
Proof.
  apply certified_share_of_gain with (weights := ball 1 1); try lra.
  - apply ball_supports.
  - apply unit_weight.
  - intros pi _. rewrite value_keep. apply value_at_most.
  - apply keep_remains.
  - intros; lra.
  - intros; simpl; lra.
  - intros _ [] _; [apply even_odds_honest|apply bold_honest].
Qed.

(* The certificate is given: after demonstrations from both states one policy is left, and nothing to gain. *)
Example accepted_at_once :
  accepted [[(true, true)]; [(false, true)]] [] (ln (/ 20))
    (fun pi => minus (expected_feature small 1 last_action pi)
                     (expected_feature small 1 last_action (deterministic keep))) 0.
Proof.
  split.
  - unfold valid_level, mixture; simpl. rewrite exp_ln by lra. lra.
  - intros pi I. simpl in I. destruct I as [<-|[]]. exists zero, 0, []. split; [lra|]. split; [intros ? ? []|].
    unfold dual_bound, norm, dot; simpl. unfold dot, add, scale, minus, zero; simpl.
    match goal with |- _ + _ * sqrt ?r <= _ => replace r with 0 by ring end. rewrite sqrt_0. lra.
Qed.

End Example.
