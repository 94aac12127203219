(* What staying near the expert gives every algorithm (the audit's T12 and R8), and the regret that a likelihood set
   certifies (certified answers, G6). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Logistic Bridge.Sessions
  Bridge.Certificates.
Require Import Bridge.CertifiedAnswers Bridge.Deterministic Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Moments.
Context {St Ac : finite} (H d : nat) (feature : trajectory St Ac -> vector).

(* T12, means: expected features of two trajectory laws, for features of norm b at most. *)
(* label: audit T12 *)
Theorem features_by_total_variation (E E' : environment St Ac) (pi pi' : policy St Ac) (b : R) :
  (forall t, norm d (feature t) <= b) ->
  norm d (minus (expected_feature E H feature pi) (expected_feature E' H feature pi'))
  <= 2 * b * total_variation (trajectories H) (trajectory_law E pi) (trajectory_law E' pi').
Proof.
  intros B. set (v := minus (expected_feature E H feature pi) (expected_feature E' H feature pi')).
  set (p := trajectory_law E pi). set (q := trajectory_law E' pi').
  assert (Pb : 0 <= b) by (eapply Rle_trans; [apply sqrt_pos|apply (B [])]).
  assert (T0 : 0 <= total_variation (trajectories H) p q) by apply tv_nonneg.
  assert (Q : dot d v v <= 2 * b * total_variation (trajectories H) p q * norm d v).
  { assert (E1 : dot d v v = sum (fun t => (p t - q t) * dot d (feature t) v) (trajectories H)).
    { unfold v at 1. rewrite dot_minus, <- !(dot_sym d v). unfold dot at 1 2. unfold expected_feature, mean, expect.
      change (histories (outcomes (run E pi)) H) with (trajectories (St := St) (Ac := Ac) H).
      change (histories (outcomes (run E' pi')) H) with (trajectories (St := St) (Ac := Ac) H).
      fold p. fold q. change (prob (run E pi)) with p. change (prob (run E' pi')) with q.
      transitivity (sum (fun t => p t * dot d (feature t) v - q t * dot d (feature t) v) (trajectories H)).
      2: { apply sum_ext. intros; ring. }
      rewrite sum_minus. f_equal; unfold dot.
      - transitivity (sum (fun i => sum (fun t => v i * (p t * feature t i)) (trajectories H)) (seq 0 d)).
        + apply sum_ext. intros i _. rewrite sum_scal. reflexivity.
        + rewrite sum_swap. apply sum_ext. intros t _. rewrite <- sum_scal. apply sum_ext. intros; ring.
      - transitivity (sum (fun i => sum (fun t => v i * (q t * feature t i)) (trajectories H)) (seq 0 d)).
        + apply sum_ext. intros i _. rewrite sum_scal. reflexivity.
        + rewrite sum_swap. apply sum_ext. intros t _. rewrite <- sum_scal. apply sum_ext. intros; ring. }
    rewrite E1. unfold total_variation.
    replace (2 * b * (/ 2 * sum (fun x => Rabs (p x - q x)) (trajectories H)) * norm d v)
      with (b * norm d v * sum (fun x => Rabs (p x - q x)) (trajectories H)) by field.
    rewrite <- sum_scal. apply sum_le. intros t _.
    apply Rle_trans with (Rabs (p t - q t) * Rabs (dot d (feature t) v)).
    - rewrite <- Rabs_mult. apply Rle_abs.
    - rewrite Rmult_comm. apply Rmult_le_compat_r; [apply Rabs_pos|]. pose proof (sqrt_pos (dot d v v)) as N0.
      fold (norm d v) in N0. apply Rabs_le. split.
      + assert (dot d (feature t) (scale (-1) v) <= norm d (feature t) * norm d v) as L.
        { eapply Rle_trans; [apply dot_le_norms|]. right. f_equal. unfold norm. f_equal.
          rewrite dot_scale, dot_sym, dot_scale. ring. }
        rewrite dot_sym, dot_scale, dot_sym in L. specialize (B t).
        assert (norm d (feature t) * norm d v <= b * norm d v) by (apply Rmult_le_compat_r; auto). lra.
      + eapply Rle_trans; [apply dot_le_norms|]. apply Rmult_le_compat_r; auto. }
  pose proof (sqrt_pos (dot d v v)) as N0. fold (norm d v) in N0.
  assert (Sq : norm d v * norm d v = dot d v v) by (apply sqrt_sqrt, dot_self_nonneg).
  destruct N0 as [N0|N0].
  - apply Rmult_le_reg_r with (norm d v); auto. rewrite Sq. exact Q.
  - rewrite <- N0. apply Rmult_le_pos; auto. lra.
Qed.

(* label: audit T12 *)
Theorem features_by_hellinger (E E' : environment St Ac) (pi pi' : policy St Ac) (b r : R) :
  (forall t, norm d (feature t) <= b) ->
  hellinger2 (trajectories H) (trajectory_law E pi) (trajectory_law E' pi') <= r -> r <= 1 ->
  norm d (minus (expected_feature E H feature pi) (expected_feature E' H feature pi')) <= 2 * b * sqrt (r * (2 - r)).
Proof.
  intros B L R1. assert (Pb : 0 <= b) by (eapply Rle_trans; [apply sqrt_pos|apply (B [])]).
  eapply Rle_trans; [apply features_by_total_variation; exact B|]. apply Rmult_le_compat_l; [lra|].
  pose proof (tv_by_hellinger (trajectories H) (trajectory_law E pi) (trajectory_law E' pi')
    (trajectory_law_nonneg E pi) (trajectory_law_nonneg E' pi') (trajectory_law_total E pi H)
    (trajectory_law_total E' pi' H)) as T.
  pose proof (hellinger2_range (trajectories H) (trajectory_law E pi) (trajectory_law E' pi')
    (trajectory_law_nonneg E pi) (trajectory_law_nonneg E' pi') (trajectory_law_total E pi H)
    (trajectory_law_total E' pi' H)) as G.
  apply square_le; [apply sqrt_pos|]. rewrite sqrt_sqrt by nra. nra.
Qed.

(* R8(c): no more can be lost in a round than 2 B W times the total variation from the best policy. *)
(* label: audit R8(c) *)
Theorem value_by_total_variation (E : environment St Ac) (pi pi' : policy St Ac) (w : vector) (B W : R) :
  (forall t, norm d (feature t) <= B) -> norm d w <= W ->
  value E H d feature w pi - value E H d feature w pi'
  <= 2 * B * W * total_variation (trajectories H) (trajectory_law E pi) (trajectory_law E pi').
Proof.
  intros Bf Bw. pose proof (features_by_total_variation E E pi pi' B Bf) as F.
  rewrite <- !utility_is_value. unfold utility. rewrite <- dot_minus.
  eapply Rle_trans; [apply dot_le_norms|].
  pose proof (sqrt_pos (dot d w w)) as N0. fold (norm d w) in N0.
  pose proof (sqrt_pos (dot d (minus (expected_feature E H feature pi) (expected_feature E H feature pi'))
    (minus (expected_feature E H feature pi) (expected_feature E H feature pi')))) as N1.
  fold (norm d (minus (expected_feature E H feature pi) (expected_feature E H feature pi'))) in N1.
  nra.
Qed.

(* R8(c), the regret of T rounds, two policies a round, all within total variation Delta of the best one. *)
Definition regret (E : environment St Ac) (w : vector) (best : policy St Ac) (plays : list
  (policy St Ac * policy St Ac)) : R :=
  sum (fun m => value E H d feature w best - (value E H d feature w (fst m) + value E H d feature w
    (snd m)) / 2) plays.

(* label: audit R8(c) *)
Theorem regret_of_every_algorithm (E : environment St Ac) (best : policy St Ac) (w : vector) (B W Delta : R)
  (plays : list (policy St Ac * policy St Ac)) :
  (forall t, norm d (feature t) <= B) -> norm d w <= W ->
  (forall pi, In pi (map fst plays) \/ In pi (map snd plays) ->
     total_variation (trajectories H) (trajectory_law E best) (trajectory_law E pi) <= Delta) ->
  regret E w best plays <= 2 * B * W * INR (length plays) * Delta.
Proof.
  intros Bf Bw Q. unfold regret.
  assert (PB : 0 <= B) by (eapply Rle_trans; [apply sqrt_pos|apply (Bf [])]).
  assert (PW : 0 <= W) by (eapply Rle_trans; [apply sqrt_pos|exact Bw]).
  replace (2 * B * W * INR (length plays) * Delta) with (INR (length plays) * (2 * B * W * Delta)) by ring.
  rewrite <- sum_const. apply sum_le. intros m I.
  pose proof (value_by_total_variation E best (fst m) w B W Bf Bw) as V1.
  pose proof (value_by_total_variation E best (snd m) w B W Bf Bw) as V2.
  assert (T1 := Q (fst m) (or_introl (in_map fst plays m I))).
  assert (T2 := Q (snd m) (or_intror (in_map snd plays m I))).
  assert (0 <= B * W) by (apply Rmult_le_pos; auto).
  nra.
Qed.

(* For deterministic policies the total variation is the mass of disagreement. *)
(* label: audit R8(a) and (c) *)
Theorem regret_of_deterministic_policies (E : environment St Ac) (best : St -> Ac) (w : vector) (B W Delta : R)
  (plays : list ((St -> Ac) * (St -> Ac))) :
  (forall t, norm d (feature t) <= B) -> norm d w <= W ->
  (forall f, In f (map fst plays) \/ In f (map snd plays) -> hit E (deterministic f) H (differ best f) <= Delta) ->
  regret E w (deterministic best) (map (fun m => (deterministic (fst m), deterministic (snd m))) plays)
  <= 2 * B * W * INR (length plays) * Delta.
Proof.
  intros Bf Bw Q. rewrite <- (map_length (fun m => (deterministic (fst m), deterministic (snd m))) plays).
  apply regret_of_every_algorithm; auto. intros pi I.
  assert (exists f, pi = deterministic f /\ (In f (map fst plays) \/ In f (map snd plays))) as [f [-> J]].
  { rewrite !map_map in I. simpl in I. destruct I as [I|I]; apply in_map_iff in I; destruct I as [m [<- I]].
    - exists (fst m). split; auto. left. apply in_map; auto.
    - exists (snd m). split; auto. right. apply in_map; auto. }
  destruct (deterministic_distance E H best f) as [_ ->]. apply Q; auto.
Qed.

End Moments.

Section Likelihood.
Context {Q : Type} (d : nat) (x : Q -> vector) (weights : vector -> Prop) (s : vector -> R).
Hypothesis support : supports d s weights.
Context {C : Type} (candidates : list C) (phi : C -> vector) (wstar : vector).

(* G6, containment: the best candidate is never behind another one for all plausible weights. *)
(* label: companion G6 *)
Theorem best_is_contained level h pistar :
  plausible d x weights level h wstar -> best d candidates phi wstar pistar ->
  forall pi, In pi candidates ->
    exists w, plausible d x weights level h w /\ 0 <= dot d (minus (phi pistar) (phi pi)) w.
Proof.
  intros P B pi I. exists wstar. split; auto. rewrite dot_minus. specialize (B pi I). unfold utility in B. lra.
Qed.

(* The direction of the regret against pi of the pairs that were played. *)
Fixpoint hindsight (plays : list (C * C)) (pi : C) : vector :=
  match plays with
  | [] => zero
  | (a, b) :: rest => add (minus (phi pi) (scale (/ 2) (add (phi a) (phi b)))) (hindsight rest pi)
  end.

Lemma hindsight_is plays pi w :
  dot d (hindsight plays pi) w = sum (fun m => utility d phi w pi - (utility d phi w
    (fst m) + utility d phi w (snd m)) / 2) plays.
Proof.
  induction plays as [|[a b] plays IH]; [apply dot_zero|]. cbn [hindsight sum fst snd].
  rewrite dot_add, dot_minus, dot_scale, dot_add, IH. unfold utility. field.
Qed.

(* G6: the regret of the whole session by the set after its last answer. *)
(* label: companion G6 *)
Theorem certified_regret level h remaining plays eps pistar :
  plausible d x weights level h wstar -> In pistar remaining -> best d candidates phi wstar pistar ->
  certified d x s candidates phi level h remaining (hindsight plays) eps ->
  sum (fun m => utility d phi wstar pistar - (utility d phi wstar (fst m) + utility d phi wstar
    (snd m)) / 2) plays <= eps.
Proof.
  intros P I B K. rewrite <- hindsight_is.
  apply (certified_direction d x weights s support candidates phi wstar level h remaining
    (hindsight plays) eps); auto.
Qed.

End Likelihood.

Section Examples.

Lemma last_action_bound t : norm 1 (last_action t) <= 1.
Proof.
  rewrite <- sqrt_1. apply sqrt_le_1_alt. unfold dot, last_action; simpl.
  destruct t as [|[s a] t]; [lra|]. pose proof (indicator_range a). nra.
Qed.

Example features_by_total_variation_nonvacuous :
  norm 1 (minus (expected_feature estimated 2 last_action random_policy)
    (expected_feature small 2 last_action random_policy))
  <= 2 * 1 * total_variation (trajectories 2) (trajectory_law estimated random_policy)
    (trajectory_law small random_policy).
Proof. apply features_by_total_variation. apply last_action_bound. Qed.

Example features_by_hellinger_nonvacuous :
  norm 1 (minus (expected_feature estimated 2 last_action random_policy)
    (expected_feature small 2 last_action random_policy))
  <= 2 * 1 * sqrt (1 * (2 - 1)).
Proof.
  apply features_by_hellinger; [apply last_action_bound| |lra].
  apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total.
Qed.

Example value_by_total_variation_nonvacuous :
  value small 2 1 last_action one_dimension
    (deterministic keep) - value small 2 1 last_action one_dimension random_policy
  <= 2 * 1 * 1 * total_variation (trajectories 2) (trajectory_law small (deterministic keep))
    (trajectory_law small random_policy).
Proof. apply value_by_total_variation; [apply last_action_bound|apply unit_weight]. Qed.

Lemma small_variation f g : hit small (deterministic f) 2 (differ g f) <= 1.
Proof. apply Pr_range. Qed.

Example regret_of_deterministic_policies_nonvacuous :
  regret 2 1 last_action small one_dimension (deterministic keep)
    (map (fun m => (deterministic (fst m), deterministic (snd m))) [(stay_in_first, keep); (keep, keep)])
  <= 2 * 1 * 1 * INR (length [(stay_in_first, keep); (keep, keep)]) * 1.
Proof.
  apply regret_of_deterministic_policies; [apply last_action_bound|apply unit_weight|]. intros; apply small_variation.
Qed.

Example regret_of_every_algorithm_nonvacuous :
  regret 2 1 last_action small one_dimension (deterministic keep) [(deterministic keep, deterministic keep)]
  <= 2 * 1 * 1 * INR (length [(deterministic (St := two) keep, deterministic (St := two) keep)]) * 0.
Proof.
  apply regret_of_every_algorithm; [apply last_action_bound|apply unit_weight|].
  intros pi I. assert (pi = deterministic keep) as ->
    by (simpl in I; tauto || (destruct I as [[<-|[]]|[<-|[]]]; reflexivity)).
  right. unfold total_variation. transitivity (/ 2 * sum (fun _ : trajectory two two => 0) (trajectories 2)).
  - f_equal. apply sum_ext. intros t _. rewrite Rminus_eq_0. apply Rabs_R0.
  - rewrite sum_zero. ring.
Qed.

Let x (_ : unit) : vector := one_dimension.
Let h : list (unit * answer) := [(tt, First)].
Let phi (pi : bool) : vector := if pi then one_dimension else zero.

Lemma first_is_best : best 1 [true; false] phi one_dimension true.
Proof. intros [] _; unfold utility, phi, dot, one_dimension, zero; simpl; lra. Qed.

Example best_is_contained_nonvacuous :
  exists w, plausible 1 x (ball 1 1) (- 2) h w /\ 0 <= dot 1 (minus (phi true) (phi false)) w.
Proof.
  apply best_is_contained with (candidates := [true; false]) (wstar := one_dimension); simpl; auto.
  - split; [apply unit_weight|apply answer_plausible].
  - apply first_is_best.
Qed.

Example certified_regret_nonvacuous :
  sum (fun m => utility 1 phi one_dimension true
    - (utility 1 phi one_dimension (fst m) + utility 1 phi one_dimension (snd m)) / 2) [(true, true)] <= 0.
Proof.
  apply certified_regret with (x := x) (weights := ball 1 1) (s := fun u => 1 * norm 1 u) (candidates :=
    [true; false])
    (level := - 2) (h := h) (remaining := [true]); simpl; auto.
  - apply ball_supports.
  - split; [apply unit_weight|apply answer_plausible].
  - apply first_is_best.
  - intros pi [<-|[]]. exists zero, 0, []. split; [lra|]. split; [intros ? ? []|].
    cbn [map]. unfold x, h. rewrite bound_without_answers. cbn [hindsight].
    unfold add, minus, scale, zero, phi, one_dimension.
    replace (1 - / 2 * (1 + 1) + 0) with 0 by field. rewrite Rabs_R0. lra.
Qed.

End Examples.
