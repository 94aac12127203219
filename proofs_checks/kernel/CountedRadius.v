(* Radius zero for the package's count estimate
  (the audit's T8(A)), and the capacity behind the counting of the set (T14). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet Bridge.Deterministic.
Require Import Bridge.Cloning Bridge.CountEstimate Bridge.ZeroRadius Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Counts.
Context {St Ac : finite}.

Notation data := (list (trajectory St Ac)).

(* Rows without data keep the state. *)
Definition self_loop (s : St) (_ : Ac) : law St := dirac s.

Lemma arrival_visited (D : data) m s' : In ((m, s') : pairs (pairs St Ac) St) (flat_map transitions D) ->
  visited D s' = true.
Proof.
  intros I. apply in_flat_map in I. destruct I as [t [I J]]. apply existsb_exists. exists t. split; auto.
  apply existsb_exists. clear I. induction t as [|[s1 a1] t IH]; [destruct J|].
  destruct t as [|m0 t]; [destruct J|]. cbn [transitions] in J. destruct J as [J|J].
  - inversion J; subst. exists (s', a1). split; [left; auto|apply eqb_refl].
  - destruct (IH J) as [m1 [K Q]]. exists m1. split; [right; auto|auto].
Qed.

(* label: audit T8(A), discharge for the package's estimate *)
Theorem count_estimate_is_closed (D : data) (start : law St) :
  (forall s, visited D s = false -> start s = 0) -> closed D start (count_estimate self_loop D).
Proof.
  intros Z. split; auto. intros t s a s' I J V. cbn [count_estimate mass]. unfold count_mass.
  destruct (Rle_dec _ 0) as [L|L].
  - unfold self_loop; cbn [dirac mass]. unfold dirac_mass. replace (eqb s' s) with false; [reflexivity|].
    symmetry. apply eqb_false. intros ->. rewrite (pair_visited D t s a I J) in V. discriminate.
  - assert (count (flat_map transitions D) (((s, a), s') : pairs (pairs St Ac) St) = O) as ->; [|simpl; field; lra].
    unfold count. destruct (filter _ (flat_map transitions D)) as [|z l] eqn:F; auto. exfalso.
    assert (In z (z :: l)) as K by (left; auto). rewrite <- F in K. apply filter_In in K. destruct K as [K Q].
    apply eqb_true in Q. subst z. rewrite (arrival_visited D _ s' K) in V. discriminate.
Qed.

(* From a fixed first state: the expert is at distance zero of the package's clone, for all data that it can give. *)
(* label: audit T8(A), for the package's algorithms *)
Theorem radius_zero_of_counts (first : St) (Pstar : St -> Ac -> law St) (expert : St -> Ac) (default : Ac) (H : nat)
  (D : data) :
  possible (markov (dirac first) Pstar) (deterministic expert) D -> visited D first = true ->
  distance_to_clone (markov (dirac first) (count_estimate self_loop D)) H (deterministic expert)
    (deterministic (first_action default D)) = 0.
Proof.
  intros P V. apply expert_at_radius_zero with (Pstar := markov (dirac first) Pstar) (D := D); auto.
  - apply (first_action_clones (markov (dirac first) Pstar) expert default D P).
  - apply count_estimate_is_closed. intros s U. cbn [dirac mass]. unfold dirac_mass.
    replace (eqb s first) with false; [reflexivity|]. symmetry. apply eqb_false. intros ->. congruence.
Qed.

(* T14: the mass of meeting a set of states is a monotone and submodular function of the set. *)
(* label: audit T14 *)
Theorem hitting_mass_is_submodular (E : environment St Ac) (pi : policy St Ac) (H : nat) (A B : St -> bool) :
  (hit E pi H (fun s => A s && B s) <= hit E pi H A /\ hit E pi H A <= hit E pi H (fun s => A s || B s))
  /\ hit E pi H (fun s => A s || B s) + hit E pi H (fun s => A s && B s) <= hit E pi H A + hit E pi H B.
Proof.
  split; [split; apply hit_monotone; intros s; destruct (A s), (B s); auto|].
  unfold hit, Pr. rewrite <- !expect_plus. apply expect_le. intros t _ _.
  assert (O : visits (fun s => A s || B s) t = visits A t || visits B t).
  { unfold visits. induction t as [|m t IH]; [reflexivity|]. cbn [existsb]. rewrite IH.
    destruct (A (fst m)), (B (fst m)), (existsb (fun m => A (fst m)) t); auto. }
  assert (N : visits (fun s => A s && B s) t = true -> visits A t = true /\ visits B t = true).
  { intros V. apply existsb_exists in V. destruct V as [m [I V]]. apply andb_prop in V. destruct V.
    split; apply existsb_exists; exists m; auto. }
  rewrite O. destruct (visits (fun s => A s && B s) t).
  - destruct (N eq_refl) as [-> ->]. simpl. lra.
  - pose proof (indicator_range (visits A t)). destruct (visits A t), (visits B t); simpl; lra.
Qed.

End Counts.

Section Examples.

Let D : list (trajectory two two) := [[(true, true); (true, true)]].

Lemma visit_possible : possible (markov (dirac (true : two)) true_kernel) (deterministic keep) D.
Proof.
  intros t [<-|[]]. unfold trajectory_law; cbn [prob step run]. unfold run_step; simpl. unfold dirac_mass; simpl. lra.
Qed.

Example count_estimate_is_closed_nonvacuous :
  closed D (dirac (true : two)) (count_estimate self_loop D).
Proof. apply count_estimate_is_closed. intros [] V; [discriminate|reflexivity]. Qed.

Example radius_zero_of_counts_nonvacuous :
  distance_to_clone (markov (dirac (true : two)) (count_estimate self_loop D)) 3 (deterministic keep)
    (deterministic (first_action (St := two) (Ac := two) false D)) = 0.
Proof. apply radius_zero_of_counts with true_kernel; [apply visit_possible|reflexivity]. Qed.

Example hitting_mass_is_submodular_nonvacuous :
  let A : two -> bool := fun s => s in
  let B : two -> bool := fun s => negb s in
  (hit small random_policy 2 (fun s => A s && B s) <= hit small random_policy 2 A
   /\ hit small random_policy 2 A <= hit small random_policy 2 (fun s => A s || B s))
  /\ hit small random_policy 2 (fun s => A s || B s) + hit small random_policy 2 (fun s => A s && B s)
     <= hit small random_policy 2 A + hit small random_policy 2 B.
Proof. intros A B. apply hitting_mass_is_submodular. Qed.

End Examples.
