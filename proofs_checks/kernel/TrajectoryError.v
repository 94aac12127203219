(* The error of a trajectory law by the errors of the kernel's rows (the audit's T1), and the other way round (T4).

   Two environments, the estimate and the truth, with a common policy;
     d_t are their occupancies at step t = 0, 1, ... *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.HellingerRecursion Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section TrajectoryError.
Context {St Ac : finite}.

Section Environments.
Variables (Phat Pstar : environment St Ac) (pi : policy St Ac).

Notation estimate := (trajectory_law Phat pi).
Notation truth := (trajectory_law Pstar pi).

(* The overlap of the laws of t steps, and the error of the row after a prefix. *)
Definition prefix_overlap (t : nat) : R := overlap (trajectories t) estimate truth.
Definition row_error_after (h : trajectory St Ac) : R := hellinger2 (elements St) (Phat h) (Pstar h).
Definition g_prefix (h : trajectory St Ac) : R := sqrt (estimate h * truth h).

Lemma row_error_after_range h : 0 <= row_error_after h <= 1.
Proof. apply hellinger2_range; apply mass_nonneg || apply mass_total. Qed.

Lemma overlap_step t : prefix_overlap (S t) = sum (fun h => g_prefix h * (1 - row_error_after h)) (trajectories t).
Proof.
  unfold prefix_overlap, overlap, trajectories. cbn [histories]. rewrite sum_flat_map. apply sum_ext. intros h _.
  rewrite sum_map, sum_pairs. unfold row_error_after, hellinger2.
  replace (1 - (1 - overlap (elements St) (Phat h) (Pstar h))) with (overlap (elements St) (Phat h)
    (Pstar h)) by ring.
  unfold overlap. rewrite <- sum_scal. apply sum_ext. intros s _.
  rewrite <- (Rmult_1_r (sqrt (Phat h s * Pstar h s))), <- (mass_total (pi h s)), <- !sum_scal.
  apply sum_ext. intros a _.
  unfold trajectory_law; cbn [prob step run]. unfold run_step; cbn [fst snd].
  unfold g_prefix, trajectory_law.
  rewrite <- (sqrt_square (pi h s a)) at 3 by apply mass_nonneg.
  rewrite <- !root_mult;
    repeat (apply Rmult_le_pos; try apply mass_nonneg; try apply prob_nonneg);
    try apply mass_nonneg; try apply prob_nonneg.
  f_equal. ring.
Qed.

Lemma overlap_falls t : prefix_overlap (S t) = prefix_overlap t - sum
  (fun h => g_prefix h * row_error_after h) (trajectories t).
Proof.
  rewrite overlap_step. unfold prefix_overlap, overlap. rewrite <- sum_minus. apply sum_ext. intros h _.
    unfold g_prefix. ring.
Qed.

Lemma prefix_overlap_falls t k : prefix_overlap (t + k) <= prefix_overlap t.
Proof.
  induction k as [|k IH]; [rewrite <- plus_n_O; lra|]. rewrite <- plus_n_Sm, overlap_falls.
  assert (0 <= sum (fun h => g_prefix h * row_error_after h) (trajectories (t + k))); [|lra].
  apply sum_nonneg. intros h _. apply Rmult_le_pos; [apply sqrt_pos|apply row_error_after_range].
Qed.

Lemma prefix_overlap_zero : prefix_overlap 0 = 1.
Proof. unfold prefix_overlap, overlap; simpl. rewrite Rmult_1_l, sqrt_1. ring. Qed.

(* T4 at one step, for prefixes of t steps and the row that follows. *)
Lemma row_error_of_prefix t :
  sum (fun h => truth h * row_error_after h) (trajectories t) <=
    (1 - prefix_overlap (S t)) * (1 + prefix_overlap (S t)).
Proof.
  rewrite overlap_step. set (o := sum (fun h => g_prefix h * (1 - row_error_after h)) (trajectories t)).
  assert (o * o <= 1 - sum (fun h => truth h * row_error_after h) (trajectories t)); [|nra].
  pose proof (cauchy_schwarz (fun h => sqrt (estimate h)) (fun h => sqrt (truth h) * (1 - row_error_after h))
    (trajectories t)) as CS. cbv beta in CS.
  assert (sum (fun h => sqrt (estimate h) * (sqrt (truth h) * (1 - row_error_after h))) (trajectories t) = o) as E1.
  { apply sum_ext. intros h _. unfold g_prefix. rewrite root_mult by apply prob_nonneg. ring. }
  assert (sum (fun h => sqrt (estimate h) * sqrt (estimate h)) (trajectories t) = 1) as E2.
  { rewrite <- (trajectory_law_total Phat pi t). apply sum_ext. intros h _. apply sqrt_sqrt, prob_nonneg. }
  rewrite E1, E2, Rmult_1_l in CS. eapply Rle_trans; [exact CS|].
  replace (1 - sum (fun h => truth h * row_error_after h) (trajectories t))
    with (sum (fun h => truth h - truth h * row_error_after h) (trajectories t))
    by (rewrite sum_minus, (trajectory_law_total Pstar pi t); reflexivity).
  apply sum_le. intros h _. pose proof (row_error_after_range h).
  replace (sqrt (truth h) * (1 - row_error_after h) * (sqrt (truth h) * (1 - row_error_after h)))
    with ((sqrt (truth h) * sqrt (truth h)) * ((1 - row_error_after h) * (1 - row_error_after h))) by ring.
  rewrite sqrt_sqrt by apply prob_nonneg. pose proof (trajectory_law_nonneg Pstar pi h).
  assert ((1 - row_error_after h) * (1 - row_error_after h) <= 1 - row_error_after h) by nra. nra.
Qed.

End Environments.

(* The arrival of the last transition adds what one more state would. *)
(* label: audit, conventions of the horizon *)
Theorem arrival_convention (Phat Pstar : environment St Ac) (pi : policy St Ac) T :
  hellinger2 (arrivals T) (arrival_law Phat pi) (arrival_law Pstar pi)
  = hellinger2 (trajectories (S T)) (trajectory_law Phat pi) (trajectory_law Pstar pi).
Proof.
  unfold hellinger2. f_equal. change (overlap (trajectories (S T)) (trajectory_law Phat pi) (trajectory_law Pstar pi))
    with (prefix_overlap Phat Pstar pi (S T)). rewrite overlap_step.
  unfold overlap at 1, arrivals. rewrite sum_list_prod. apply sum_ext. intros h _.
  unfold row_error_after, hellinger2, g_prefix, overlap.
  replace (1 - (1 - sum (fun x => sqrt (Phat h x * Pstar h x)) (elements St)))
    with (sum (fun x => sqrt (Phat h x * Pstar h x)) (elements St)) by ring.
  rewrite <- sum_scal. apply sum_ext. intros s _. unfold arrival_law; cbn [fst snd].
  rewrite <- root_mult; repeat (apply Rmult_le_pos; try apply mass_nonneg; try apply prob_nonneg).
  f_equal. ring.
Qed.

Section Mdps.
Variables (start : law St) (Phat Pstar : St -> Ac -> law St) (pi : policy St Ac).

Notation estimate := (markov start Phat).
Notation truth := (markov start Pstar).

(* The distance of the trajectory laws with T transitions, T + 1 states with their actions. *)
Definition trajectory_error (T : nat) : R :=
  hellinger2 (trajectories (S T)) (trajectory_law estimate pi) (trajectory_law truth pi).

Definition row_error (m : pairs St Ac) : R := hellinger2 (elements St) (Phat (fst m) (snd m)) (Pstar (fst m) (snd m)).

Definition ends_with (m : pairs St Ac) (h : trajectory St Ac) : bool :=
  match h with [] => false | m' :: _ => eqb (m' : pairs St Ac) m end.

(* g_t(s, a): the overlap of the prefixes that end in (s, a). *)
Definition g_overlap (t : nat) (m : pairs St Ac) : R :=
  sum (fun h => indicator (ends_with m h) * sqrt (trajectory_law estimate pi h * trajectory_law truth pi h))
    (trajectories (S t)).

Definition occupancy (E : environment St Ac) (t : nat) (m : pairs St Ac) : R := Pr (run E pi) (S t) (ends_with m).

Lemma row_error_range m : 0 <= row_error m <= 1.
Proof. apply hellinger2_range; apply mass_nonneg || apply mass_total. Qed.

(* Sorting the prefixes by their last pair. *)
Lemma by_last_pair t (w f : trajectory St Ac -> R) (c : pairs St Ac -> R) :
  (forall m h, w (m :: h) = f (m :: h) * c m) ->
  sum w (trajectories (S t))
  = sum (fun m => sum (fun h => indicator (ends_with m h) * f h) (trajectories (S t)) * c m) (elements (pairs St Ac)).
Proof.
  intros E.
  transitivity (sum (fun m => sum (fun h => indicator (ends_with m h) * f h * c m) (trajectories (S t)))
    (elements (pairs St Ac))).
  2: { apply sum_ext. intros m _. apply sum_scal_r. }
  rewrite sum_swap. apply sum_ext. intros h I. pose proof (histories_length_list _ _ _ I) as L.
  destruct h as [|m h]; [discriminate|]. rewrite E. unfold ends_with.
  transitivity (sum (fun y : pairs St Ac => indicator (eqb y m) * (f (m :: h) * c y)) (elements (pairs St Ac))).
  - symmetry. apply (sum_at (m : pairs St Ac) (fun y => f (m :: h) * c y)).
  - apply sum_ext. intros y _. replace (eqb (m : pairs St Ac) y) with (eqb y m); [ring|].
    destruct (eqb y m) eqn:F; symmetry; [apply eqb_true in F; subst; apply eqb_refl|].
    apply eqb_false. intros K. subst. rewrite eqb_refl in F. discriminate.
Qed.

Lemma row_error_markov m h : row_error_after estimate truth (m :: h) = row_error m.
Proof. destruct m as [s a]. reflexivity. Qed.

Lemma first_step : prefix_overlap estimate truth pi 1 = 1.
Proof.
  rewrite overlap_falls, prefix_overlap_zero. simpl. unfold row_error_after, hellinger2, overlap, g_prefix; simpl.
  replace (sum (fun s => sqrt (start s * start s)) (elements St)) with (sum start (elements St)).
  - rewrite mass_total. ring.
  - apply sum_ext. intros s _. symmetry. apply sqrt_square, mass_nonneg.
Qed.

(* label: audit T1 *)
Theorem trajectory_error_identity T :
  trajectory_error T
  = sum (fun t => sum (fun m => g_overlap t m * row_error m) (elements (pairs St Ac))) (seq 0 T).
Proof.
  unfold trajectory_error, hellinger2.
  change (overlap (trajectories (S T)) (trajectory_law estimate pi) (trajectory_law truth pi))
    with (prefix_overlap estimate truth pi (S T)).
  induction T as [|T IH]; [rewrite first_step; simpl; ring|].
  rewrite seq_S, sum_app, <- IH, overlap_falls. simpl sum at 2.
  rewrite (by_last_pair T _ (g_prefix estimate truth pi) row_error).
  - unfold g_overlap, g_prefix. simpl. ring.
  - intros m h. rewrite row_error_markov. reflexivity.
Qed.

Lemma g_below_occupancies t m : g_overlap t m <= sqrt (occupancy estimate t m * occupancy truth t m).
Proof.
  assert (G : 0 <= g_overlap t m).
  { apply sum_nonneg. intros. apply Rmult_le_pos; [apply indicator_range|apply sqrt_pos]. }
  rewrite <- (sqrt_square (g_overlap t m)) by auto. apply sqrt_le_1_alt.
  pose proof (cauchy_schwarz (fun h => indicator (ends_with m h) * sqrt (trajectory_law estimate pi h))
    (fun h => indicator (ends_with m h) * sqrt (trajectory_law truth pi h)) (trajectories (S t))) as CS.
  cbv beta in CS.
  assert (Q : forall E, sum (fun h => indicator (ends_with m h) * sqrt (trajectory_law E pi h)
    * (indicator (ends_with m h) * sqrt (trajectory_law E pi h))) (trajectories (S t)) = occupancy E t m).
  { intros E. unfold occupancy, Pr, expect. apply sum_ext. intros h _.
    fold (trajectory_law E pi h). rewrite <- (sqrt_sqrt (trajectory_law E pi h)) at 3 by apply prob_nonneg.
    destruct (ends_with m h); simpl; ring. }
  rewrite !Q in CS. eapply Rle_trans; [|exact CS]. right.
  assert (g_overlap t m = sum (fun h => indicator (ends_with m h) * sqrt (trajectory_law estimate pi h)
    * (indicator (ends_with m h) * sqrt (trajectory_law truth pi h))) (trajectories (S t))) as ->; [|reflexivity].
  apply sum_ext. intros h _. rewrite root_mult by apply prob_nonneg. destruct (ends_with m h); simpl; ring.
Qed.

Lemma occupancy_nonneg E t m : 0 <= occupancy E t m.
Proof. apply Pr_range. Qed.

(* T1, the bound: constant 1 with the mean of the two occupancies. *)
(* label: audit T1 *)
Theorem trajectory_error_symmetrised T :
  trajectory_error T
  <= / 2 * sum (fun t => sum (fun m => occupancy estimate t m * row_error m) (elements (pairs St Ac))
                        + sum (fun m => occupancy truth t m * row_error m) (elements (pairs St Ac))) (seq 0 T).
Proof.
  rewrite trajectory_error_identity, <- sum_scal. apply sum_le. intros t _.
  rewrite <- sum_plus, <- sum_scal. apply sum_le. intros m _.
  pose proof (row_error_range m). pose proof (g_below_occupancies t m) as G.
  pose proof (occupancy_nonneg estimate t m) as D1. pose proof (occupancy_nonneg truth t m) as D2.
  assert (sqrt (occupancy estimate t m * occupancy truth t m) <= (occupancy estimate t m + occupancy truth t m) / 2).
  { apply square_le; [lra|]. rewrite sqrt_sqrt by (apply Rmult_le_pos; auto).
    pose proof (square_nonneg (occupancy estimate t m - occupancy truth t m)). nra. }
  nra.
Qed.

Lemma expected_row_error t :
  sum (fun m => occupancy truth t m * row_error m) (elements (pairs St Ac))
  = sum (fun h => trajectory_law truth pi h * row_error_after estimate truth h) (trajectories (S t)).
Proof.
  rewrite (by_last_pair t _ (trajectory_law truth pi) row_error).
  - apply sum_ext. intros m _. f_equal. unfold occupancy, Pr, expect. apply sum_ext. intros h _. apply Rmult_comm.
  - intros m h. rewrite row_error_markov. reflexivity.
Qed.

Lemma trajectory_error_range T : 0 <= trajectory_error T <= 1.
Proof. apply hellinger2_range; apply trajectory_law_nonneg || apply trajectory_law_total. Qed.

(* T4, one step: the expected row error under the true occupancy. *)
(* label: audit T4 *)
Theorem row_error_at_step T t : (t < T)%nat ->
  sum (fun m => occupancy truth t m * row_error m) (elements (pairs St Ac)) <=
    trajectory_error T * (2 - trajectory_error T).
Proof.
  intros L. rewrite expected_row_error.
  eapply Rle_trans; [apply row_error_of_prefix|]. pose proof (trajectory_error_range T) as R1.
  pose proof (trajectory_error_range (S t)) as R2.
  assert (prefix_overlap estimate truth pi (S T) <= prefix_overlap estimate truth pi (S (S t))) as Q.
  { replace (S T) with (S (S t) + (T - S t))%nat by lia. apply prefix_overlap_falls. }
  unfold trajectory_error, hellinger2 in *.
  change (overlap (trajectories (S T)) (trajectory_law estimate pi) (trajectory_law truth pi))
    with (prefix_overlap estimate truth pi (S T)) in *.
  change (overlap (trajectories (S (S t))) (trajectory_law estimate pi) (trajectory_law truth pi))
    with (prefix_overlap estimate truth pi (S (S t))) in *.
  nra.
Qed.

(* The first transition alone: its prefix has the same law under both. *)
Lemma row_error_at_start T : (0 < T)%nat ->
  sum (fun m => occupancy truth 0 m * row_error m) (elements (pairs St Ac)) <= trajectory_error T.
Proof.
  intros L. rewrite expected_row_error.
  assert (sum (fun h => trajectory_law truth pi h * row_error_after estimate truth h) (trajectories 1)
    = trajectory_error 1) as ->.
  - unfold trajectory_error, hellinger2.
    change (overlap (trajectories 2) (trajectory_law estimate pi) (trajectory_law truth pi))
      with (prefix_overlap estimate truth pi 2).
    rewrite overlap_falls, first_step.
    replace (1 - (1 - sum (fun h => g_prefix estimate truth pi h * row_error_after estimate truth h)
      (trajectories 1)))
      with (sum (fun h => g_prefix estimate truth pi h * row_error_after estimate truth h) (trajectories 1)) by ring.
    apply sum_ext. intros h I. f_equal. pose proof (histories_length_list _ _ _ I) as Lh.
    destruct h as [|[s a] [|]]; try discriminate. unfold g_prefix, trajectory_law; cbn [prob step run].
    unfold run_step; cbn [fst snd markov]. rewrite Rmult_1_l. symmetry. apply sqrt_square.
    apply Rmult_le_pos; apply mass_nonneg.
  - unfold trajectory_error, hellinger2.
    change (overlap (trajectories (S T)) (trajectory_law estimate pi) (trajectory_law truth pi))
      with (prefix_overlap estimate truth pi (S T)).
    change (overlap (trajectories 2) (trajectory_law estimate pi) (trajectory_law truth pi))
      with (prefix_overlap estimate truth pi 2).
    assert (prefix_overlap estimate truth pi (S T) <= prefix_overlap estimate truth pi 2); [|lra].
    replace (S T) with (2 + (T - 1))%nat by lia. apply prefix_overlap_falls.
Qed.

(* T4, summed over the T transitions. *)
(* label: audit T4 *)
Theorem row_error_summed T : (0 < T)%nat ->
  sum (fun t => sum (fun m => occupancy truth t m * row_error m) (elements (pairs St Ac))) (seq 0 T)
  <= trajectory_error T * (1 + (INR T - 1) * (2 - trajectory_error T)).
Proof.
  intros L. destruct T as [|T]; [lia|]. cbn [seq sum].
  pose proof (row_error_at_start (S T) L) as Q0.
  assert (sum (fun t => sum (fun m => occupancy truth t m * row_error m) (elements (pairs St Ac))) (seq 1 T)
    <= INR T * (trajectory_error (S T) * (2 - trajectory_error (S T)))) as Q1.
  { rewrite <- (seq_length T 1) at 2. rewrite <- sum_const. apply sum_le. intros t I. apply in_seq in I.
    apply row_error_at_step. lia. }
  rewrite S_INR. lra.
Qed.

End Mdps.
End TrajectoryError.

Notation small_error := (trajectory_error fair wrong_kernel true_kernel random_policy).

Example arrival_convention_nonvacuous :
  hellinger2 (arrivals 2) (arrival_law estimated random_policy) (arrival_law small random_policy)
  = hellinger2 (trajectories 3) (trajectory_law estimated random_policy) (trajectory_law small random_policy).
Proof. apply arrival_convention. Qed.

Example trajectory_error_identity_nonvacuous :
  small_error 2 = sum (fun t => sum (fun m => g_overlap fair wrong_kernel true_kernel random_policy t m
    * row_error wrong_kernel true_kernel m) (elements (pairs two two))) (seq 0 2).
Proof. apply trajectory_error_identity. Qed.

Example trajectory_error_symmetrised_nonvacuous :
  small_error 2 <= / 2 * sum (fun t =>
    sum (fun m => occupancy random_policy estimated t m * row_error wrong_kernel true_kernel m) (elements
      (pairs two two))
    + sum (fun m => occupancy random_policy small t m * row_error wrong_kernel true_kernel m) (elements
      (pairs two two)))
    (seq 0 2).
Proof. apply trajectory_error_symmetrised. Qed.

Example row_error_at_step_nonvacuous :
  sum (fun m => occupancy random_policy small 1 m * row_error wrong_kernel true_kernel m) (elements (pairs two two))
  <= small_error 2 * (2 - small_error 2).
Proof. apply row_error_at_step. lia. Qed.

Example row_error_summed_nonvacuous :
  sum (fun t => sum (fun m => occupancy random_policy small t m * row_error wrong_kernel true_kernel m)
    (elements (pairs two two))) (seq 0 2)
  <= small_error 2 * (1 + (INR 2 - 1) * (2 - small_error 2)).
Proof. apply row_error_summed. lia. Qed.
