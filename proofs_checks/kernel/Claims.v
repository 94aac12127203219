(* Claims of the paper about finite models, each as a proposition over all models of its kind.

   Every one of them is false; the refutations are generated from the counterexamples of the ledger. Trajectories
   include the last arrival, so that H counts transitions, as in the paper's appendix. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Distances Bridge.Arithmetic Bridge.Formulas.
Import ListNotations.
Open Scope R_scope.

(* The probability of a pair at a step, the first step being 0. *)
Definition pair_occupancy {St Ac : finite} (E : environment St Ac) (pi : policy St Ac) (t : nat) (s : St) (a : Ac) : R :=
  Pr (run E pi) (S t) (fun h => match h with [] => false | m :: _ => eqb (m : pairs St Ac) (s, a) end).

Section Quantities.
Context {St Ac : finite} (start : law St) (P Phat : St -> Ac -> law St).

(* H^2 between the estimated and the true law of the trajectories of one policy. *)
Definition trajectory_error (pi : policy St Ac) (H : nat) : R :=
  hellinger2 (arrivals H) (arrival_law (markov start Phat) pi) (arrival_law (markov start P) pi).

(* H^2 between the laws of two policies under one kernel. *)
Definition policy_error (kernel : St -> Ac -> law St) (pi pi' : policy St Ac) (H : nat) : R :=
  hellinger2 (arrivals H) (arrival_law (markov start kernel) pi) (arrival_law (markov start kernel) pi').

Definition row_error (s : St) (a : Ac) : R := hellinger2 (elements St) (P s a) (Phat s a).

(* The expectation of a number of each pair under the truth at a step, the first step being 0. *)
Definition expected (pi : policy St Ac) (t : nat) (f : St -> Ac -> R) : R :=
  sum (fun m => pair_occupancy (markov start P) pi t (fst m) (snd m) * f (fst m) (snd m)) (elements (pairs St Ac)).

(* C is at least the largest ratio of visitations, over the pairs that the expert visits. *)
Definition concentrability (expert pi : policy St Ac) (H : nat) (C : R) : Prop :=
  forall t s a, (t < H)%nat -> 0 < pair_occupancy (markov start P) expert t s a ->
    pair_occupancy (markov start P) pi t s a <= C * pair_occupancy (markov start P) expert t s a.

(* The expert visits at every step every pair that the policy visits. *)
Definition full_support (expert pi : policy St Ac) (H : nat) : Prop :=
  forall t s a, (t < H)%nat -> 0 < pair_occupancy (markov start P) pi t s a ->
    0 < pair_occupancy (markov start P) expert t s a.

End Quantities.

(* lemma:technical_result, its proof's Step 1 *)
Definition step_1 : Prop := forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (f : St -> Ac) (H : nat),
  trajectory_error start P Phat (deterministic f) H
    <= sum (fun t => expected start P (deterministic f) t (row_error P Phat)) (seq 0 H).

(* Its proof's Step 2 *)
Definition step_2 : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (expert f : St -> Ac) (H t : nat) (C : R),
  (t < H)%nat -> concentrability start P (deterministic expert) (deterministic f) H C ->
  expected start P (deterministic f) t (row_error P Phat)
    <= C * expected start P (deterministic expert) t (row_error P Phat).

(* Its proof's Step 3 *)
Definition step_3 : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (f : St -> Ac) (H : nat), (1 <= H)%nat ->
  / INR H * sum (fun t => expected start P (deterministic f) t (row_error P Phat)) (seq 0 H)
    <= trajectory_error start P Phat (deterministic f) H.

(* A formula in its proof *)
Definition product_formula : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (f : St -> Ac) (H : nat),
  trajectory_error start P Phat (deterministic f) H
    = 1 - product (fun t => expected start P (deterministic f) t (fun s a => overlap (elements St) (P s a) (Phat s a)))
        (seq 0 H).

(* lemma:technical_result *)
Definition technical_lemma : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (expert f : St -> Ac) (H : nat) (C : R),
  concentrability start P (deterministic expert) (deterministic f) H C ->
  trajectory_error start P Phat (deterministic f) H
    <= INR H * C * trajectory_error start P Phat (deterministic expert) H.

(* The same for policies that remember, even where the expert visits whatever the policy visits *)
Definition technical_lemma_with_full_support : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (expert pi : policy St Ac) (H : nat) (C : R),
  full_support start P expert pi H -> concentrability start P expert pi H C ->
  trajectory_error start P Phat pi H <= INR H * C * trajectory_error start P Phat expert H.

(* lemma:confidence_set_construction with the root of 2, for stochastic policies *)
Definition root_two : Prop :=
  forall (St Ac : finite) (start : law St) (P Phat : St -> Ac -> law St) (expert pi : St -> law Ac) (H : nat),
  sqrt (policy_error start Phat (stationary expert) (stationary pi) H)
    <= sqrt (policy_error start P (stationary expert) (stationary pi) H)
      + sqrt (2 * trajectory_error start P Phat (stationary expert) H).

(* local:feature_difference_main: two policies of the confidence set have features that differ by little *)
Definition feature_difference : Prop :=
  forall (St Ac : finite) (start : law St) (Phat : St -> Ac -> law St) (clone f g : St -> Ac) (H n : nat)
    (delta gamma B : R) (feature : list (St * Ac) -> R),
  let E := markov start Phat in
  let near := fun h : St -> Ac =>
    hellinger (trajectories H) (trajectory_law E (deterministic clone)) (trajectory_law E (deterministic h))
      <= offline_radius (size St) (size Ac) H n delta gamma in
  0 < delta < 1 -> 0 < gamma ->
  (forall t s a, (t < H)%nat -> 0 < pair_occupancy E (deterministic clone) t s a ->
    gamma <= pair_occupancy E (deterministic clone) t s a) ->
  (forall h, - B <= feature h <= B) -> offline_radius (size St) (size Ac) H n delta gamma < 1 -> near f -> near g ->
  (mean E (deterministic f) H feature - mean E (deterministic g) H feature) ^ 2 <= 32 * B ^ 2 / INR n.

(* Claims about laws and numbers *)

(* lem:concentrability_coefficient_bound, where its proof bounds total variation by the Hellinger distance *)
Definition tv_below_hellinger : Prop := forall (X : finite) (p q : law X),
  total_variation (elements X) p q ^ 2 <= hellinger2 (elements X) p q.

(* corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies: the union over policies *)
Definition union_step : Prop := forall (S A : nat) (delta : R), (1 <= S)%nat -> (1 <= A)%nat -> 0 < delta < 1 ->
  2 * INR A ^ S / delta <= (INR A / delta) ^ S.

(* lem:transition_covering_number_stationary_tabular_stochastic_transitions: the size of its proof's grid *)
Definition grid_size : Prop := forall epsilon, 0 < epsilon < 1 ->
  ceiling (2 * ln (1 / epsilon) / epsilon) + 1 <= 1 / epsilon + 1.

(* lemma:feature_diff_bound: the first squared norm of the potential against the logarithm *)
Definition log_potential : Prop := forall D start, 0 < start -> D ^ 2 / start <= 2 * ln (1 + D ^ 2 / start).

(* local:regime_transition: the factor falls with the dimension *)
Definition falls_with_dimension : Prop := forall small large x, 0 < small <= large -> 0 <= x ->
  sqrt (large * ln (1 + x / large)) <= sqrt (small * ln (1 + x / small)).

(* lemma:term_2_asymptotic_bound: a feature difference by the drift of one policy and the difference before *)
Definition three_squares : Prop := forall now_1 now_2 before_1 before_2,
  (now_1 - now_2) ^ 2
    <= 2 * Rmax (Rabs (now_1 - before_1)) (Rabs (now_2 - before_2)) ^ 2 + (before_1 - before_2) ^ 2.

(* lemma:regret_analysis: twice the regret of a round by true and estimated utilities *)
Definition decomposition : Prop := forall best one two best_hat one_hat two_hat,
  (best - one) + (best - two)
    = (best_hat - one_hat) + (best_hat - two_hat) + 2 * (best_hat - best) + (one_hat - one) + (two_hat - two).

(* local:kappa: the inverse slope of the sigmoid at differences of features *)
Definition sigmoid (x : R) : R := 1 / (1 + exp (- x)).
Definition curvature_of_differences : Prop := forall phi_1 phi_2 w B W,
  - B <= phi_1 <= B -> - B <= phi_2 <= B -> - W <= w <= W ->
  1 / (sigmoid ((phi_1 - phi_2) * w) * (1 - sigmoid ((phi_1 - phi_2) * w))) <= kappa B W.
