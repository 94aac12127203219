(* Behavioural cloning of a deterministic expert: its error is the mass of trajectories that meet a state without data
   (the audit's T7). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet
  Bridge.Deterministic Bridge.Small.
Import ListNotations.
Open Scope R_scope.

(* The nonempty subsets of a list. *)
Fixpoint nonempty_subsets {A : Type} (l : list A) : list (list A) :=
  match l with
  | [] => []
  | x :: rest => [x] :: map (cons x) (nonempty_subsets rest) ++ nonempty_subsets rest
  end.

Lemma nonempty_subsets_number {A : Type} (l : list A) : INR (length (nonempty_subsets l)) = 2 ^ length l - 1.
Proof.
  induction l as [|x l IH]; [simpl; ring|]. cbn [nonempty_subsets length]. rewrite app_length, map_length.
  rewrite S_INR, plus_INR, IH. simpl. ring.
Qed.

Lemma filter_is_subset {A : Type} (b : A -> bool) (l : list A) :
  filter b l = [] \/ In (filter b l) (nonempty_subsets l).
Proof.
  induction l as [|x l IH]; [left; reflexivity|]. cbn [filter nonempty_subsets]. destruct (b x).
  - right. destruct IH as [-> | I]; [left; reflexivity|]. right. apply in_or_app. left. apply in_map. exact I.
  - destruct IH as [-> | I]; [left; reflexivity|]. right. right. apply in_or_app. right. exact I.
Qed.

Section Cloning.
Context {St Ac : finite} (E : environment St Ac) (expert : St -> Ac) (H n : nat).

Notation data := (list (trajectory St Ac)).
Notation truth := (deterministic expert).

(* Was an action recorded in state s? *)
Definition visited (D : data) (s : St) : bool := existsb (visits (fun s' => eqb s' s)) D.
Definition unvisited (D : data) (s : St) : bool := negb (visited D s).

(* The likelihood of the recorded actions; a clone maximises it over the deterministic policies. *)
Definition action_likelihood (f : St -> Ac) (D : data) : R := product (policy_factor (deterministic f)) D.
Definition is_clone (D : data) (f : St -> Ac) : Prop := forall g, action_likelihood g D <= action_likelihood f D.

(* Cloning: a clone for every data set that the expert can give. *)
Definition clones (clone : data -> St -> Ac) : Prop := forall D, possible E truth D -> is_clone D (clone D).

Lemma likelihood_is f (D : data) : action_likelihood f D = indicator (forallb (follows f) D).
Proof.
  unfold action_likelihood. induction D as [|t D IH]; [reflexivity|]. cbn [product forallb].
  rewrite IH, deterministic_factor. destruct (follows f t), (forallb (follows f) D); simpl; ring.
Qed.

Lemma clone_follows D f : possible E truth D -> is_clone D f -> forallb (follows f) D = true.
Proof.
  intros P C. specialize (C expert). rewrite !likelihood_is in C.
  assert (forallb (follows expert) D = true) as Q.
  { apply forallb_forall. intros t I. apply possible_follows with E. apply P; auto. }
  rewrite Q in C. destruct (forallb (follows f) D); auto. simpl in C. lra.
Qed.

Lemma visited_pair D s : visited D s = true -> exists t a, In t D /\ In (s, a) t.
Proof.
  intros V. apply existsb_exists in V. destruct V as [t [I V]]. apply existsb_exists in V.
  destruct V as [[s' a] [J V]]. apply eqb_true in V. simpl in V. subst. exists t, a. auto.
Qed.

Lemma pair_visited D t s a : In t D -> In (s, a) t -> visited D s = true.
Proof.
  intros I J. apply existsb_exists. exists t. split; auto. apply existsb_exists. exists (s, a). split; auto.
  apply eqb_refl.
Qed.

Lemma followers_agree D f g s : forallb (follows f) D = true -> forallb (follows g) D = true ->
  visited D s = true -> f s = g s.
Proof.
  intros F G V. destruct (visited_pair D s V) as [t [a [I J]]]. rewrite forallb_forall in F, G.
  rewrite <- (follows_pair f t s a (F t I) J). apply (follows_pair g t s a (G t I) J).
Qed.

Lemma expert_follows D : possible E truth D -> forallb (follows expert) D = true.
Proof. intros P. apply forallb_forall. intros t I. apply possible_follows with E. apply P; auto. Qed.

Lemma clone_agrees D f s : possible E truth D -> is_clone D f -> visited D s = true -> f s = expert s.
Proof. intros P C V. apply (followers_agree D); auto using clone_follows, expert_follows. Qed.

Lemma difference_unvisited D f s : possible E truth D -> is_clone D f ->
  differ f expert s = true -> unvisited D s = true.
Proof.
  intros P C Q. unfold unvisited. destruct (visited D s) eqn:V; auto.
  unfold differ in Q. rewrite (clone_agrees D f s P C V), eqb_refl in Q. discriminate.
Qed.

(* T7: the clone errs by the mass of the trajectories that meet a state without data, at most. *)
(* label: audit T7 *)
Theorem clone_error_is_missing_mass D f : possible E truth D -> is_clone D f ->
  policy_error E H truth (deterministic f) = hit E truth H (differ f expert)
  /\ policy_error E H truth (deterministic f) <= hit E truth H (unvisited D).
Proof.
  intros P C. unfold policy_error. destruct (deterministic_distance E H f expert) as [Q _]. rewrite Q. split; auto.
  apply hit_monotone. intros s. apply difference_unvisited; auto.
Qed.

Lemma hit_range A : 0 <= hit E truth H A <= 1.
Proof. apply Pr_range. Qed.

Notation demos := (demonstrations E truth H).

Lemma never_hit A : Pr demos n (forallb (fun t => negb (visits A t))) = (1 - hit E truth H A) ^ n.
Proof.
  unfold demonstrations. rewrite Pr_forall. f_equal. unfold hit. rewrite <- Pr_not. reflexivity.
Qed.

Definition member (B : list St) (s : St) : bool := if in_dec (same St) s B then true else false.

(* T7(b), the tail: a set of states of mass above r stays without data with probability (1 - r)^n at most. *)
(* label: audit T7(b) *)
Theorem missing_mass_tail r : 0 <= r <= 1 ->
  with_probability demos (1 - (2 ^ size St - 1) * (1 - r) ^ n) n (fun D => hit E truth H (unvisited D) <= r).
Proof.
  intros Pr0.
  set (bad := fun (B : list St) (D : data) =>
    (if Rle_dec (hit E truth H (member B)) r then false else true) && forallb (fun t => negb (visits
      (member B) t)) D).
  apply with_probability_not with (b := fun D => existsb (fun B => bad B D) (nonempty_subsets (elements St))).
  - eapply Rle_trans; [apply Pr_union|].
    apply Rle_trans with (sum (fun _ => (1 - r) ^ n) (nonempty_subsets (elements St))).
    2: { rewrite sum_const, nonempty_subsets_number. right; reflexivity. }
    apply sum_le. intros B _. unfold bad. destruct (Rle_dec (hit E truth H (member B)) r) as [L|L].
    + unfold Pr; simpl. rewrite expect_const. apply pow_le. lra.
    + simpl. change (Pr demos n (forallb (fun t => negb (visits (member B) t))) <= (1 - r) ^ n).
      rewrite never_hit. apply pow_incr. pose proof (hit_range (member B)). lra.
  - intros D _ _ F. destruct (Rle_lt_dec (hit E truth H (unvisited D)) r) as [L|L]; auto. exfalso.
    set (B := filter (unvisited D) (elements St)).
    assert (Q : forall s, member B s = unvisited D s).
    { intros s. unfold member. destruct (in_dec (same St) s B) as [I|I].
      - apply filter_In in I. symmetry; tauto.
      - destruct (unvisited D s) eqn:U; auto. destruct I. apply filter_In. split; auto. apply complete. }
    assert (Eh : hit E truth H (member B) = hit E truth H (unvisited D)).
    { apply Rle_antisym; apply hit_monotone; intros s; rewrite Q; auto. }
    destruct (filter_is_subset (unvisited D) (elements St)) as [Z|I].
    + fold B in Z. rewrite <- Eh in L.
      assert (hit E truth H (member B) <= 0); [|lra].
      unfold hit. rewrite <- (expect_const (run E truth) H 0). apply expect_le. intros t _ _.
      rewrite Z. replace (visits (member []) t) with false; [simpl; lra|].
      symmetry. apply visits_none. intros; reflexivity.
    + fold B in I. assert (existsb (fun B => bad B D) (nonempty_subsets (elements St)) = true); [|congruence].
      apply existsb_exists. exists B. split; auto. unfold bad. rewrite Eh.
      destruct (Rle_dec (hit E truth H (unvisited D)) r); [lra|]. simpl. apply forallb_forall. intros t J.
      apply negb_true_iff, visits_none. intros s a K. rewrite Q. unfold unvisited.
      rewrite (pair_visited D t s a J K). reflexivity.
Qed.

(* T7(b): the logarithmic form; the number of actions does not enter. *)
(* label: audit T7(b) *)
Theorem missing_mass_bound delta : (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n
    (fun D => hit E truth H (unvisited D) <= (INR (size St) * ln 2 + ln (/ delta)) / INR n).
Proof.
  intros Pn Pd. pose proof (lt_0_INR n Pn) as Pn'.
  set (r := (INR (size St) * ln 2 + ln (/ delta)) / INR n).
  assert (L2 : 0 <= ln 2) by (rewrite <- ln_1; left; apply ln_increasing; lra).
  assert (Ld : 0 <= ln (/ delta)).
  { rewrite ln_Rinv by lra. destruct (proj2 Pd) as [L| ->]; [|rewrite ln_1; lra].
    pose proof (ln_increasing delta 1 (proj1 Pd) L) as Q. rewrite ln_1 in Q. lra. }
  assert (Pr : 0 <= r).
  { unfold r, Rdiv. apply Rmult_le_pos; [|left; apply Rinv_0_lt_compat; auto].
    pose proof (pos_INR (size St)). nra. }
  destruct (Rle_lt_dec r 1) as [R1|R1].
  - apply with_probability_weaken with (1 - (2 ^ size St - 1) * (1 - r) ^ n).
    2: { apply missing_mass_tail; lra. }
    assert (E1 : (1 - r) ^ n <= exp (- (INR n * r))).
    { replace (exp (- (INR n * r))) with (exp (- r) ^ n).
      - apply pow_incr. split; [lra|]. pose proof (one_plus_le_exp (- r)). lra.
      - rewrite <- Rpower_pow by apply exp_pos. unfold Rpower. rewrite ln_exp. f_equal. ring. }
    assert (E2 : 2 ^ size St * exp (- (INR n * r)) = delta).
    { unfold r. replace (INR n * ((INR (size St) * ln 2 + ln (/ delta)) / INR n))
        with (INR (size St) * ln 2 + ln (/ delta)) by (field; lra).
      rewrite ln_Rinv by lra. rewrite <- Rpower_pow by lra. unfold Rpower. rewrite <- exp_plus.
      replace (INR (size St) * ln 2 + - (INR (size St) * ln 2 + - ln delta)) with (ln delta) by ring.
      apply exp_ln. lra. }
    assert (0 <= (1 - r) ^ n) by (apply pow_le; lra).
    assert (0 < 2 ^ size St) by (apply pow_lt; lra). nra.
  - apply with_probability_weaken with 1;
    [lra|]. apply surely. intros D _ _. pose proof (hit_range (unvisited D)). lra.
Qed.

(* T7(b): the exact tail, inverted. *)
(* label: audit T7(b) *)
Theorem missing_mass_sharp delta : (0 < n)%nat -> 0 < delta < 1 -> (0 < size St)%nat ->
  with_probability demos (1 - delta) n
    (fun D => hit E truth H (unvisited D) <= 1 - Rpower (delta / (2 ^ size St - 1)) (/ INR n)).
Proof.
  intros Pn Pd Ps. pose proof (lt_0_INR n Pn) as Pn'.
  assert (P2 : 1 <= 2 ^ size St - 1).
  { destruct (size St) as [|k]; [lia|]. simpl. pose proof (pow_R1_Rle 2 k). lra. }
  assert (Q : 0 < delta / (2 ^ size St - 1) <= 1).
  { split.
    - unfold Rdiv. apply Rmult_lt_0_compat; [lra|]. apply Rinv_0_lt_compat; lra.
    - apply Rmult_le_reg_r with (2 ^ size St - 1); [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  set (x := Rpower (delta / (2 ^ size St - 1)) (/ INR n)).
  assert (X0 : 0 < x) by apply exp_pos.
  assert (X1 : x ^ n = delta / (2 ^ size St - 1)).
  { rewrite <- Rpower_pow by auto. unfold x. rewrite Rpower_mult, Rinv_l by lra. apply Rpower_1. lra. }
  assert (X2 : x <= 1).
  { destruct (Rle_lt_dec x 1) as [L|L]; auto. exfalso.
    pose proof (Rlt_pow_R1 x n L Pn). lra. }
  apply with_probability_weaken with (1 - (2 ^ size St - 1) * (1 - (1 - x)) ^ n).
  - replace (1 - (1 - x)) with x by ring. rewrite X1. right. field. lra.
  - apply missing_mass_tail. lra.
Qed.

(* The same for the error of every clone. *)
(* label: audit T7(b) *)
Theorem clone_error_bound clone delta : clones clone -> (0 < n)%nat -> 0 < delta <= 1 ->
  with_probability demos (1 - delta) n (fun D =>
    policy_error E H truth (deterministic (clone D)) <= (INR (size St) * ln 2 + ln (/ delta)) / INR n).
Proof.
  intros C Pn Pd. eapply with_probability_impl; [|apply missing_mass_bound; eauto].
  intros D _ L Q. cbv beta in Q. pose proof (possible_data E truth H D L) as P.
  destruct (clone_error_is_missing_mass D (clone D) P (C D P)) as [_ B]. lra.
Qed.

(* T7(a): the expected error, from the probabilities q of visiting each state. *)
Definition reach (s : St) : R := hit E truth H (fun s' => eqb s' s).

Lemma one_state_maximum q : (0 < n)%nat -> 0 <= q <= 1 ->
  q * (1 - q) ^ n <= / (INR n + 1) * (INR n / (INR n + 1)) ^ n.
Proof.
  intros Pn Pq. pose proof (lt_0_INR n Pn) as Pn'.
  set (y := (INR n + 1) * q - 1).
  assert (Eq : q = (1 + y) * / (INR n + 1)) by (unfold y; field; lra).
  assert (E1 : 1 - q = INR n / (INR n + 1) * (1 - y / INR n)) by (unfold y; field; lra).
  assert (P0 : 0 < / (INR n + 1)) by (apply Rinv_0_lt_compat; lra).
  assert (P1 : 0 < INR n / (INR n + 1)) by (unfold Rdiv; apply Rmult_lt_0_compat; auto).
  assert (P2 : 0 <= 1 - y / INR n).
  { apply Rmult_le_reg_l with (INR n / (INR n + 1)); auto. rewrite <- E1. lra. }
  assert (P3 : 0 <= 1 + y) by (unfold y; nra).
  rewrite E1, Rpow_mult_distr. rewrite Eq.
  assert (B : (1 - y / INR n) ^ n <= exp (- y)).
  { replace (exp (- y)) with (exp (- y / INR n) ^ n).
    - apply pow_incr. split; auto. pose proof (one_plus_le_exp (- y / INR n)).
      replace (1 - y / INR n) with (1 + - y / INR n) by (unfold Rdiv; ring). auto.
    - rewrite <- Rpower_pow by apply exp_pos. unfold Rpower. rewrite ln_exp. f_equal. field. lra. }
  assert (G : (1 + y) * (1 - y / INR n) ^ n <= 1).
  { apply Rle_trans with (exp y * exp (- y)).
    - apply Rmult_le_compat; auto; [apply pow_le; auto|apply one_plus_le_exp].
    - rewrite <- exp_plus. replace (y + - y) with 0 by ring. rewrite exp_0. lra. }
  assert (0 <= (INR n / (INR n + 1)) ^ n) by (apply pow_le; lra).
  replace ((1 + y) * / (INR n + 1) * ((INR n / (INR n + 1)) ^ n * (1 - y / INR n) ^ n))
    with (((1 + y) * (1 - y / INR n) ^ n) * (/ (INR n + 1) * (INR n / (INR n + 1)) ^ n)) by ring.
  rewrite <- (Rmult_1_l (/ (INR n + 1) * (INR n / (INR n + 1)) ^ n)) at 2.
  apply Rmult_le_compat_r; auto. apply Rmult_le_pos; lra.
Qed.

(* label: audit T7(a) *)
Theorem expected_missing_mass : (0 < n)%nat ->
  expect demos n (fun D => hit E truth H (unvisited D)) <= sum (fun s => reach s * (1 - reach s) ^ n) (elements St)
  /\ sum (fun s => reach s * (1 - reach s) ^ n) (elements St)
     <= INR (size St) * (/ (INR n + 1) * (INR n / (INR n + 1)) ^ n).
Proof.
  intros Pn. split.
  - apply Rle_trans with (expect demos n (fun D => sum (fun s =>
      reach s * indicator (forallb (fun t => negb (visits (fun s' => eqb s' s) t)) D)) (elements St))).
    + apply expect_le. intros D _ _. unfold hit, Pr.
      apply Rle_trans with (expect (run E truth) H (fun t => sum (fun s =>
        indicator (visits (fun s' => eqb s' s) t) * indicator (unvisited D s)) (elements St))).
      * apply expect_le. intros t _ _. destruct (visits (unvisited D) t) eqn:V.
        -- apply existsb_exists in V. destruct V as [[s a] [I V]]. cbn [fst] in V.
           assert (visits (fun s' => eqb s' s) t = true) as W.
           { apply existsb_exists. exists (s, a). split; auto. apply eqb_refl. }
           eapply Rle_trans; [|apply term_le_sum with (x := s)].
           ++ cbv beta. rewrite W, V. simpl. lra.
           ++ intros. apply Rmult_le_pos; apply indicator_range.
           ++ apply complete.
        -- apply sum_nonneg. intros. apply Rmult_le_pos; apply indicator_range.
      * rewrite (expect_sum (run E truth) H (fun s t => indicator (visits (fun s' => eqb s' s) t)
          * indicator (unvisited D s))). apply sum_le. intros s _.
        rewrite (expect_ext _ _ _ (fun t => indicator (unvisited D s) * indicator (visits (fun s' => eqb s' s) t)))
          by (intros; ring).
        rewrite expect_scal. unfold reach, hit, Pr. rewrite Rmult_comm. apply Rmult_le_compat_l.
        { apply expect_nonneg. intros; apply indicator_range. }
        unfold unvisited, visited. right. f_equal. induction D as [|t D IH]; simpl; auto.
        rewrite <- IH, negb_orb. reflexivity.
    + rewrite (expect_sum demos n (fun s D => reach s
        * indicator (forallb (fun t => negb (visits (fun s' => eqb s' s) t)) D))).
      apply sum_le. intros s _. rewrite expect_scal. right. f_equal. apply never_hit.
  - unfold size. rewrite <- sum_const. apply sum_le. intros s _. apply one_state_maximum; auto. apply hit_range.
Qed.

(* T7(e): where every state that the expert reaches has probability gamma at least, the clone is the expert there. *)
(* label: audit T7(e) *)
Theorem exact_recovery clone gamma : clones clone -> 0 < gamma <= 1 ->
  (forall s, 0 < reach s -> gamma <= reach s) ->
  with_probability demos (1 - INR (size St) * (1 - gamma) ^ n) n (fun D =>
    (forall s, 0 < reach s -> clone D s = expert s) /\ policy_error E H truth (deterministic (clone D)) = 0).
Proof.
  intros C Pg Q.
  apply with_probability_not with (b := fun D => existsb (fun s =>
    (if Rlt_dec 0 (reach s) then true else false) && forallb (fun t => negb (visits (fun s' => eqb s' s) t)) D)
    (elements St)).
  - eapply Rle_trans; [apply Pr_union|]. unfold size. rewrite <- sum_const. apply sum_le. intros s _.
    destruct (Rlt_dec 0 (reach s)) as [L|L].
    + simpl. change (Pr demos n (forallb (fun t => negb (visits (fun s' => eqb s' s) t))) <= (1 - gamma) ^ n).
      rewrite never_hit. apply pow_incr. specialize (Q s L). pose proof (hit_range (fun s' => eqb s' s)).
      unfold reach in Q. lra.
    + unfold Pr; simpl. rewrite expect_const. apply pow_le. lra.
  - intros D _ L F. pose proof (possible_data E truth H D L) as P.
    assert (G : forall s, 0 < reach s -> clone D s = expert s).
    { intros s R0. apply (clone_agrees D); auto. destruct (visited D s) eqn:V; auto. exfalso.
      assert (existsb (fun s => (if Rlt_dec 0 (reach s) then true else false)
        && forallb (fun t => negb (visits (fun s' => eqb s' s) t)) D) (elements St) = true); [|congruence].
      apply existsb_exists. exists s. split; [apply complete|]. destruct (Rlt_dec 0 (reach s)); [|lra]. simpl.
      apply forallb_forall. intros t I. destruct (visits (fun s' => eqb s' s) t) eqn:W; auto.
      exfalso. assert (visited D s = true); [|congruence]. apply existsb_exists. exists t. auto. }
    split; auto. unfold policy_error. destruct (deterministic_distance E H (clone D) expert) as [-> _].
    unfold hit, Pr. rewrite <- (expect_const (run E truth) H 0). apply expect_ext. intros t I T.
    destruct (visits (differ (clone D) expert) t) eqn:V; auto. exfalso.
    apply existsb_exists in V. destruct V as [[s a] [J V]]. cbn [fst] in V.
    unfold differ in V. rewrite (G s), eqb_refl in V; [discriminate|].
    unfold reach, hit, Pr, expect. apply Rlt_le_trans with (prob (run E truth) t).
    + exact T.
    + eapply Rle_trans; [|apply term_le_sum with (x := t); auto].
      * cbv beta. replace (visits (fun s' => eqb s' s) t) with true; [simpl; lra|].
        symmetry. apply existsb_exists. exists (s, a). split; auto. apply eqb_refl.
      * intros u _. apply Rmult_le_pos; [apply prob_nonneg|apply indicator_range].
Qed.

(* The package's clone: the first recorded action of the state, and a default where none is recorded. *)
Variable default : Ac.

Definition first_action (D : data) (s : St) : Ac :=
  match find (fun m => eqb (fst m) s) (concat D) with Some m => snd m | None => default end.

(* label: audit T7, discharge for the package's clone *)
Theorem first_action_clones : clones first_action.
Proof.
  intros D P g. rewrite !likelihood_is. replace (forallb (follows (first_action D)) D) with true.
  - apply indicator_range.
  - symmetry. apply forallb_forall. intros t I. apply forallb_forall. intros [s a] J. cbn [fst snd].
    pose proof (expert_follows D P) as F. rewrite forallb_forall in F.
    rewrite (follows_pair expert t s a (F t I) J). apply eqb_true. unfold first_action.
    destruct (find (fun m => eqb (fst m) s) (concat D)) as [[s' a']|] eqn:X.
    + destruct (find_some _ _ X) as [K Es]. cbn [fst snd] in *. apply eqb_true in Es. subst s'.
      apply in_concat in K. destruct K as [u [K1 K2]]. symmetry. apply (follows_pair expert u s a' (F u K1) K2).
    + exfalso. pose proof (find_none _ _ X (s, a)) as N. cbn [fst] in N. rewrite eqb_refl in N.
      discriminate N. apply in_concat. exists t. auto.
Qed.

End Cloning.

(* The small process: the clone by first recorded actions, with action false where nothing is recorded. *)
Section Examples.

Let clone := first_action (St := two) (Ac := two) false.

Lemma small_clones : clones small keep clone.
Proof. apply first_action_clones. Qed.

Example first_action_clones_nonvacuous : clones small keep clone.
Proof. apply first_action_clones. Qed.

Lemma possible_visit : possible small (deterministic keep) [[(true, true); (true, true)]].
Proof.
  intros t [<-|[]]. unfold trajectory_law; cbn [prob step run]. unfold run_step; simpl. unfold dirac_mass; simpl. lra.
Qed.

Example clone_error_is_missing_mass_nonvacuous :
  let D := [[(true, true); (true, true)]] : list (trajectory two two) in
  policy_error small 2 (deterministic keep) (deterministic (clone D))
    = hit small (deterministic keep) 2 (differ (clone D) keep)
  /\ policy_error small 2 (deterministic keep) (deterministic (clone D))
    <= hit small (deterministic keep) 2 (unvisited D).
Proof.
  intros D. apply clone_error_is_missing_mass; [apply possible_visit|]. apply small_clones, possible_visit.
Qed.

Example missing_mass_tail_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - (2 ^ size two - 1) * (1 - / 2) ^ 5) 5
    (fun D => hit small (deterministic keep) 2 (unvisited D) <= / 2).
Proof. apply missing_mass_tail. lra. Qed.

Example missing_mass_bound_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - / 20) 5
    (fun D => hit small (deterministic keep) 2 (unvisited D) <= (INR (size two) * ln 2 + ln (/ / 20)) / INR 5).
Proof. apply missing_mass_bound; [lia|lra]. Qed.

Example missing_mass_sharp_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - / 20) 5
    (fun D => hit small (deterministic keep) 2 (unvisited D) <= 1 - Rpower (/ 20 / (2 ^ size two - 1)) (/ INR 5)).
Proof. apply missing_mass_sharp; [lia|lra|simpl; unfold size; simpl; lia]. Qed.

Example clone_error_bound_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 2) (1 - / 20) 5 (fun D =>
    policy_error small 2 (deterministic keep) (deterministic (clone D))
    <= (INR (size two) * ln 2 + ln (/ / 20)) / INR 5).
Proof. apply clone_error_bound; [apply small_clones|lia|lra]. Qed.

Example expected_missing_mass_nonvacuous :
  expect (demonstrations small (deterministic keep) 2) 5 (fun D => hit small (deterministic keep) 2 (unvisited D))
  <= sum (fun s => reach small keep 2 s * (1 - reach small keep 2 s) ^ 5) (elements two)
  /\ sum (fun s => reach small keep 2 s * (1 - reach small keep 2 s) ^ 5) (elements two)
     <= INR (size two) * (/ (INR 5 + 1) * (INR 5 / (INR 5 + 1)) ^ 5).
Proof. apply expected_missing_mass. lia. Qed.

Lemma small_reach s : reach small keep 1 s = / 2.
Proof.
  unfold reach, hit, Pr, expect; simpl. unfold run_step; simpl. unfold dirac_mass; simpl.
  destruct s; simpl; lra.
Qed.

Example exact_recovery_nonvacuous :
  with_probability (demonstrations small (deterministic keep) 1) (1 - INR (size two) * (1 - / 2) ^ 9) 9 (fun D =>
    (forall s, 0 < reach small keep 1 s -> clone D s = keep s)
    /\ policy_error small 1 (deterministic keep) (deterministic (clone D)) = 0).
Proof.
  apply exact_recovery; [apply small_clones|lra|]. intros s _. rewrite small_reach. lra.
Qed.

End Examples.
