(* BRIDGE with known dynamics as its description has it, in one feature dimension, and what thm:main_known implies.

   The theorem bounds the regret with probability at least 1 - delta. So there are, in every model, a cloned policy,
   weights and pairs that follow the algorithm's rule and meet the bound. That much is refuted: on one state and two
   actions every run has the largest regret, whatever the answers, the estimates and the clone. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Distances Bridge.Formulas.
Import ListNotations.
Open Scope R_scope.

Section Algorithm.
Context {St Ac : finite} (start : law St) (P : St -> Ac -> law St) (H : nat) (phi : list (St * Ac) -> R).
Context (B W lam delta : R) (n T : nat) (clone : St -> Ac) (weight : nat -> R) (pair : nat -> (St -> Ac) * (St -> Ac)).

Definition feature (f : St -> Ac) : R := mean (markov start P) (deterministic f) H phi.

Definition offline_set (f : St -> Ac) : Prop :=
  hellinger (trajectories H) (trajectory_law (markov start P) (deterministic clone))
    (trajectory_law (markov start P) (deterministic f)) <= offline_radius_known (size St) (size Ac) n delta.

Definition difference (t : nat) : R := feature (fst (pair t)) - feature (snd (pair t)).
Definition data_matrix (t : nat) : R := kappa B W * lam + sum (fun l => difference l ^ 2) (seq 1 (t - 1)).
Definition norm (t : nat) (x : R) : R := Rabs x / sqrt (data_matrix t).

Definition online_set (t : nat) (f : St -> Ac) : Prop := offline_set f /\ forall g, offline_set g ->
  0 <= (feature f - feature g) * weight t + gamma_known B W lam 1 t T delta * norm t (feature f - feature g).

(* Rounds are 1, ..., T. In each one the pair of the current set that is farthest apart is compared. *)
Definition follows_rule : Prop := forall t, (1 <= t <= T)%nat ->
  - W <= weight t <= W /\ online_set t (fst (pair t)) /\ online_set t (snd (pair t)) /\
  forall f g, online_set t f -> online_set t g -> norm t (feature f - feature g) <= norm t (difference t).

Definition regret (best : St -> Ac) (truth : R) : R :=
  sum (fun t => truth * feature best - (truth * feature (fst (pair t)) + truth * feature (snd (pair t))) / 2) (seq 1 T).

End Algorithm.

Definition known_model_theorem : Prop :=
  forall (St Ac : finite) (start : law St) (P : St -> Ac -> law St) (H : nat) (phi : list (St * Ac) -> R)
    (B W lam delta truth : R) (n T : nat) (expert : St -> Ac),
  0 < B -> 0 < W -> 0 < lam -> 0 < delta < 1 -> (1 <= n)%nat -> (1 <= T)%nat -> (1 <= H)%nat ->
  (forall h, - B <= phi h <= B) -> - W <= truth <= W ->
  (forall f, truth * feature start P H phi f <= truth * feature start P H phi expert) ->
  exists clone weight pair, follows_rule start P H phi B W lam delta n T clone weight pair /\
    regret start P H phi T pair expert truth <= regret_known_stated B W lam 1 (size St) (size Ac) n T delta.

(* One state, two actions, one step; the feature of an action is B or - B. *)

Definition one : finite.
Proof. refine (Finite unit [tt] _ _ _); [decide equality | intros []; simpl; tauto | repeat constructor; simpl; tauto]. Defined.

Section TwoPolicies.
Context (B W lam delta : R) (n T : nat).
Hypothesis B_pos : 0 < B.
Hypothesis W_pos : 0 < W.
Hypothesis lam_pos : 0 < lam.
Hypothesis everything_is_near : 1 <= offline_radius_known (size one) (size two) n delta.
Hypothesis both_stay : forall t, (1 <= t <= T)%nat ->
  W * sqrt (kappa B W * lam + 4 * B ^ 2 * (INR t - 1)) <= gamma_known B W lam 1 t T delta.

Definition only : law one := dirac (tt : one).
Definition stays (s : one) (a : two) : law one := only.
Definition sign (h : list (one * two)) : R := match h with (_, true) :: _ => B | (_, false) :: _ => - B | [] => 0 end.
Definition plus (s : one) : two := true.
Definition minus (s : one) : two := false.

Notation feature_of := (feature only stays 1 sign).

Lemma feature_is f : feature_of f = if (f tt : bool) then B else - B.
Proof.
  unfold feature, mean, expect; cbn. unfold run_step, dirac_mass, eqb; cbn.
  unfold dirac_mass, eqb; cbn. destruct (f tt); cbn; ring.
Qed.

Lemma feature_plus : feature_of plus = B.
Proof. rewrite feature_is. reflexivity. Qed.

Lemma feature_minus : feature_of minus = - B.
Proof. rewrite feature_is. reflexivity. Qed.

Lemma kappa_pos : 0 < kappa B W.
Proof. unfold kappa, cosh. pose proof (exp_pos (B * W)). pose proof (exp_pos (- (B * W))). lra. Qed.

Section Run.
Context (clone : one -> two) (weight : nat -> R) (pair : nat -> (one -> two) * (one -> two)).
Hypothesis rule : follows_rule only stays 1 sign B W lam delta n T clone weight pair.

Notation gap := (difference only stays 1 sign pair).
Notation matrix := (data_matrix only stays 1 sign B W lam pair).

Lemma all_near f : offline_set only stays 1 delta n clone f.
Proof.
  unfold offline_set. eapply Rle_trans; [|exact everything_is_near]. unfold hellinger.
  rewrite <- sqrt_1. apply sqrt_le_1_alt. unfold hellinger2. pose proof (overlap_nonneg (trajectories 1)
    (trajectory_law (markov only stays) (deterministic clone)) (trajectory_law (markov only stays) (deterministic f))).
  lra.
Qed.

Lemma stay t f : (1 <= t <= T)%nat -> matrix t = kappa B W * lam + 4 * B ^ 2 * (INR t - 1) ->
  online_set only stays 1 sign B W lam delta n T clone weight pair t f.
Proof.
  intros L E. split; [apply all_near|]. intros g _.
  destruct (rule t L) as [range _]. pose proof (both_stay t L) as S. rewrite <- E in S.
  assert (0 < matrix t).
  { rewrite E. pose proof kappa_pos. assert (1 <= INR t) by (apply (le_INR 1); lia).
    assert (0 < kappa B W * lam) by (apply Rmult_lt_0_compat; auto).
    assert (0 <= B ^ 2 * (INR t - 1)) by (apply Rmult_le_pos; [apply pow2_ge_0|lra]). lra. }
  pose proof (sqrt_lt_R0 _ H). unfold norm. set (root := sqrt (matrix t)) in *.
  set (gamma := gamma_known B W lam 1 t T delta) in *.
  assert (W <= gamma / root) by (apply (Rmult_le_reg_r root); auto; field_simplify; lra).
  assert (forall x, gamma * (Rabs x / root) = gamma / root * Rabs x) as Q by (intros; field; lra). rewrite Q.
  rewrite !feature_is. destruct (f tt), (g tt); unfold Rabs; destruct (Rcase_abs _); nra.
Qed.

Lemma largest_gap t : (1 <= t <= T)%nat -> matrix t = kappa B W * lam + 4 * B ^ 2 * (INR t - 1) ->
  gap t = 2 * B \/ gap t = - (2 * B).
Proof.
  intros L E. destruct (rule t L) as [_ [_ [_ best]]].
  specialize (best plus minus (stay t plus L E) (stay t minus L E)). unfold norm in best.
  assert (0 < matrix t).
  { rewrite E. pose proof kappa_pos. assert (1 <= INR t) by (apply (le_INR 1); lia).
    assert (0 < kappa B W * lam) by (apply Rmult_lt_0_compat; auto).
    assert (0 <= B ^ 2 * (INR t - 1)) by (apply Rmult_le_pos; [apply pow2_ge_0|lra]). lra. }
  pose proof (sqrt_lt_R0 _ H) as P. apply (Rmult_le_compat_r (sqrt (matrix t))) in best; [|lra].
  unfold Rdiv in best. rewrite !Rmult_assoc, Rinv_l, !Rmult_1_r in best by lra.
  rewrite feature_plus, feature_minus in best. revert best. unfold difference. rewrite !feature_is.
  destruct (fst (pair t) tt), (snd (pair t) tt); unfold Rabs; repeat destruct (Rcase_abs _); intros; lra.
Qed.

Lemma matrix_is t : (1 <= t <= T)%nat -> matrix t = kappa B W * lam + 4 * B ^ 2 * (INR t - 1).
Proof.
  induction t as [|t IH]; intros L; [lia|]. destruct t as [|t].
  - unfold data_matrix; cbn. ring.
  - assert (1 <= S t <= T)%nat as L' by lia. specialize (IH L'). pose proof (largest_gap (S t) L' IH) as G.
    unfold data_matrix in *. replace (S (S t) - 1)%nat with (S (S t - 1)) by lia.
    rewrite seq_S, sum_app. rewrite <- Rplus_assoc, IH. replace (1 + (S t - 1))%nat with (S t) by lia.
    cbn [sum]. rewrite !S_INR. destruct G as [-> | ->]; ring.
Qed.

Lemma regret_is : regret only stays 1 sign T pair plus W = INR T * (B * W).
Proof.
  unfold regret. transitivity (sum (fun _ => B * W) (seq 1 T)).
  - apply sum_ext. intros t I. apply in_seq in I. assert (1 <= t <= T)%nat as L by lia.
    pose proof (largest_gap t L (matrix_is t L)) as G. revert G. unfold difference.
    rewrite feature_plus, !feature_is. destruct (fst (pair t) tt), (snd (pair t) tt); intros []; lra.
  - rewrite sum_const, seq_length. reflexivity.
Qed.

End Run.

Theorem two_policies : 0 < delta < 1 -> (1 <= n)%nat -> (1 <= T)%nat ->
  regret_known_stated B W lam 1 (size one) (size two) n T delta < INR T * (B * W) -> ~ known_model_theorem.
Proof.
  intros D N L bound claim.
  destruct (claim one two only stays 1%nat sign B W lam delta W n T plus) as [clone [weight [pair [rule small]]]]; auto;
    try lra.
  - intros [|[s []] h]; cbn; lra.
  - intros f. rewrite feature_plus, feature_is. destruct (f tt); nra.
  - rewrite (regret_is clone weight pair rule) in small. lra.
Qed.

End TwoPolicies.
