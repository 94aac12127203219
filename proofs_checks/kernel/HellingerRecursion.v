(* The overlap of two trajectory laws by a recursion over the states (the paper's appendix on computing distances). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Recursion.
Context {St Ac : finite} (start : law St) (P1 P2 : St -> Ac -> law St) (pi1 pi2 : St -> law Ac) (H : nat).

Notation law1 := (arrival_law (markov start P1) (stationary pi1)).
Notation law2 := (arrival_law (markov start P2) (stationary pi2)).

(* One step: the matrix M of the paper, for stochastic policies. *)
Definition overlap_matrix (s s' : St) : R :=
  sum (fun a => sqrt (pi1 s a * pi2 s a) * sqrt (P1 s a s' * P2 s a s')) (elements Ac).

Fixpoint overlap_at (t : nat) (s' : St) : R :=
  match t with
  | O => start s'
  | S k => sum (fun s => overlap_at k s * overlap_matrix s s') (elements St)
  end.

(* The matrix form, read from the right: M^t 1. *)
Fixpoint matrix_power_one (t : nat) (s : St) : R :=
  match t with
  | O => 1
  | S k => sum (fun s' => overlap_matrix s s' * matrix_power_one k s') (elements St)
  end.

Lemma overlap_at_state t s : sum (fun h => sqrt (law1 (h, s) * law2 (h, s))) (trajectories t) = overlap_at t s.
Proof.
  revert s. induction t as [|t IH]; intros s'.
  - simpl. unfold arrival_law, trajectory_law; simpl. rewrite !Rmult_1_l, sqrt_square; [ring|apply mass_nonneg].
  - unfold trajectories. cbn [histories]. rewrite sum_flat_map.
    transitivity (sum (fun h => sum (fun s => sum (fun a => sqrt (law1 (h, s) * law2 (h, s)) *
      (sqrt (pi1 s a * pi2 s a) * sqrt (P1 s a s' * P2 s a s'))) (elements Ac)) (elements St)) (trajectories t)).
    + apply sum_ext. intros h _. rewrite sum_map, sum_pairs. apply sum_ext. intros s _. apply sum_ext. intros a _.
      unfold arrival_law, trajectory_law; cbn [fst snd prob step run markov]. unfold run_step; cbn [fst snd].
      unfold stationary.
      rewrite <- !root_mult;
        repeat (apply Rmult_le_pos; try apply mass_nonneg; try apply prob_nonneg);
        try apply mass_nonneg; try apply prob_nonneg.
      f_equal. ring.
    + rewrite sum_swap. cbn [overlap_at]. apply sum_ext. intros s _. rewrite <- IH. unfold overlap_matrix.
      rewrite <- sum_scal_r. apply sum_ext. intros h _. rewrite sum_scal. reflexivity.
Qed.

(* label: paper: recursion for the overlap (K1 to K4) *)
Theorem hellinger_recursion : hellinger2 (arrivals H) law1 law2 = 1 - sum (overlap_at H) (elements St).
Proof.
  unfold hellinger2, overlap, arrivals. f_equal. rewrite sum_list_prod, sum_swap. apply sum_ext. intros s _.
  apply overlap_at_state.
Qed.

(* Without the last arrival, the last factor is the agreement of the two policies. *)
(* label: paper: recursion for the overlap (K4, main text's horizon) *)
Theorem hellinger_recursion_main_text :
  hellinger2 (trajectories (S H)) (trajectory_law (markov start P1) (stationary pi1))
    (trajectory_law (markov start P2) (stationary pi2))
  = 1 - sum (fun s => overlap_at H s * overlap (elements Ac) (pi1 s) (pi2 s)) (elements St).
Proof.
  unfold hellinger2. f_equal. unfold overlap at 1, trajectories. cbn [histories]. rewrite sum_flat_map.
  transitivity (sum (fun h => sum (fun s => sqrt (law1 (h, s) * law2 (h, s)) * overlap (elements Ac) (pi1 s) (pi2 s))
    (elements St)) (trajectories H)).
  - apply sum_ext. intros h _. rewrite sum_map, sum_pairs. apply sum_ext. intros s _.
    unfold overlap. rewrite <- sum_scal. apply sum_ext. intros a _.
    unfold arrival_law, trajectory_law; cbn [fst snd prob step run]. unfold run_step, stationary; cbn [fst snd].
    rewrite <- root_mult;
      repeat (apply Rmult_le_pos; try apply mass_nonneg; try apply prob_nonneg);
      try apply mass_nonneg; try apply prob_nonneg.
    f_equal. ring.
  - rewrite sum_swap. apply sum_ext. intros s _. rewrite sum_scal_r, overlap_at_state. reflexivity.
Qed.

Lemma forward_and_backward t k :
  sum (fun s => overlap_at t s * matrix_power_one (S k) s) (elements St) = sum (fun s => overlap_at
    (S t) s * matrix_power_one k s) (elements St).
Proof.
  cbn [overlap_at matrix_power_one].
  transitivity (sum (fun s => sum (fun s' => overlap_at t s * overlap_matrix s s' * matrix_power_one k s')
    (elements St)) (elements St)).
  - apply sum_ext. intros s _. rewrite <- sum_scal. apply sum_ext. intros. ring.
  - rewrite sum_swap. apply sum_ext. intros s' _. rewrite <- sum_scal_r. reflexivity.
Qed.

(* label: audit K5 *)
Theorem hellinger_matrix :
  hellinger2 (arrivals H) law1 law2 = 1 - sum (fun s => start s * matrix_power_one H s) (elements St).
Proof.
  rewrite hellinger_recursion. f_equal.
  assert (forall k t, sum (fun s => overlap_at t s * matrix_power_one k s) (elements St) = sum (overlap_at
    (t + k)) (elements St)) as Q.
  { induction k as [|k IH]; intros t.
    - rewrite <- plus_n_O. apply sum_ext. intros; simpl; ring.
    - rewrite forward_and_backward, IH. replace (S t + k)%nat with (t + S k)%nat by lia. reflexivity. }
  symmetry. apply (Q H 0%nat).
Qed.

End Recursion.

Example hellinger_recursion_nonvacuous :
  hellinger2 (arrivals 3) (arrival_law (markov fair true_kernel) (stationary (fun _ => fair)))
    (arrival_law (markov fair wrong_kernel) (stationary dirac))
  = 1 - sum (overlap_at fair true_kernel wrong_kernel (fun _ => fair) dirac 3) (elements two).
Proof. apply hellinger_recursion. Qed.

Example hellinger_recursion_main_text_nonvacuous :
  hellinger2 (trajectories 3) (trajectory_law (markov fair true_kernel) (stationary (fun _ => fair)))
    (trajectory_law (markov fair wrong_kernel) (stationary dirac))
  = 1 - sum (fun s => overlap_at fair true_kernel wrong_kernel (fun _ => fair) dirac 2 s * overlap
    (elements two) fair (dirac s))
          (elements two).
Proof. apply hellinger_recursion_main_text. Qed.

Example hellinger_matrix_nonvacuous :
  hellinger2 (arrivals 3) (arrival_law (markov fair true_kernel) (stationary (fun _ => fair)))
    (arrival_law (markov fair wrong_kernel) (stationary dirac))
  = 1 - sum (fun s => fair s * matrix_power_one true_kernel wrong_kernel (fun _ => fair) dirac 3 s) (elements two).
Proof. apply hellinger_matrix. Qed.
