(* Radius zero (the audit's T8): under a closed estimate all policies that agree with the data have one law; under any
   estimate the distance of expert and clone is the mass that the estimate gives to states without data. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.ConfidenceSet
  Bridge.Deterministic Bridge.Cloning
  Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section ZeroRadius.
Context {St Ac : finite} (Pstar : environment St Ac) (expert : St -> Ac) (H : nat).

Notation data := (list (trajectory St Ac)).

(* T8(B): any estimate, with any law of the first state; no probability is involved. *)
(* label: audit T8(B) *)
Theorem distance_by_unvisited_mass (D : data) (f : St -> Ac) (Phat : environment St Ac) :
  possible Pstar (deterministic expert) D -> is_clone D f ->
  distance_to_clone Phat H (deterministic expert) (deterministic f)
  <= sqrt (hit Phat (deterministic f) H (unvisited D)).
Proof.
  intros P C. unfold distance_to_clone, hellinger. apply sqrt_le_1_alt.
  destruct (deterministic_distance Phat H expert f) as [-> _]. apply hit_monotone. intros s Q.
  unfold unvisited. destruct (visited D s) eqn:V; auto. unfold differ in Q.
  rewrite (clone_agrees Pstar expert D f s P C V), eqb_refl in Q. discriminate.
Qed.

(* The estimate never leaves the states with a recorded action, as long as their recorded actions are taken. *)
Definition closed (D : data) (start : law St) (kernel : St -> Ac -> law St) : Prop :=
  (forall s, visited D s = false -> start s = 0)
  /\ forall t s a s', In t D -> In (s, a) t -> visited D s' = false -> kernel s a s' = 0.

Lemma closed_never_leaves D f start kernel : forallb (follows f) D = true -> closed D start kernel ->
  hit (markov start kernel) (deterministic f) H (unvisited D) = 0.
Proof.
  intros F [Z0 Z1]. unfold hit, Pr. rewrite <- (expect_const (run (markov start kernel) (deterministic f)) H 0).
  apply expect_ext. intros t _ L. replace (visits (unvisited D) t) with false; [reflexivity|]. symmetry.
  assert (Q : forall s a, In (s, a) t -> visited D s = true).
  { induction t as [|[s a] t IH]; [intros ? ? []|]. intros s1 a1 I.
    pose proof L as L0. cbn [prob step run] in L0. unfold run_step in L0; cbn [fst snd] in L0.
    pose proof (prob_nonneg (run (markov start kernel) (deterministic f)) t) as N1.
    pose proof (mass_nonneg (markov start kernel t) s) as N2.
    pose proof (mass_nonneg (deterministic f t s) a) as N3.
    assert (T1 : 0 < prob (run (markov start kernel) (deterministic f)) t).
    { destruct N1 as [N1|N1]; auto. rewrite <- N1 in L0. lra. }
    assert (T2 : 0 < markov start kernel t s).
    { destruct N2 as [N2|N2]; auto. rewrite <- N2 in L0. lra. }
    destruct I as [I|I]; [|apply (IH T1 s1 a1 I)]. inversion I; subst.
    destruct (visited D s1) eqn:V; auto. exfalso. destruct t as [|[s0 a0] t].
    - cbn [markov] in T2. rewrite (Z0 s1 V) in T2. lra.
    - cbn [markov] in T2. specialize (IH T1). assert (visited D s0 = true) as V0 by (apply (IH s0 a0); left; auto).
      destruct (visited_pair D s0 V0) as [u [a2 [I1 I2]]].
      assert (a0 = f s0) as Ea.
      { pose proof (possible_follows (markov start kernel) f ((s0, a0) :: t) T1) as Ff.
        apply (follows_pair f ((s0, a0) :: t)); auto. left; auto. }
      assert (a2 = f s0) as Eb.
      { rewrite forallb_forall in F. apply (follows_pair f u s0 a2 (F u I1) I2). }
      subst a0 a2. rewrite (Z1 u s0 (f s0) s1 I1 I2 V) in T2. lra. }
  apply visits_none. intros s a I. unfold unvisited. rewrite (Q s a I). reflexivity.
Qed.

(* T8(A): under a closed estimate every policy that took the recorded actions is at distance zero of the clone. *)
(* label: audit T8(A) *)
Theorem closed_distance_zero (D : data) (f g : St -> Ac) start kernel :
  forallb (follows f) D = true -> forallb (follows g) D = true -> closed D start kernel ->
  distance_to_clone (markov start kernel) H (deterministic g) (deterministic f) = 0.
Proof.
  intros F G Z. unfold distance_to_clone, hellinger.
  destruct (deterministic_distance (markov start kernel) H g f) as [-> _].
  assert (hit (markov start kernel) (deterministic f) H (differ g f) = 0) as ->; [|apply sqrt_0].
  apply Rle_antisym; [|apply Pr_range]. rewrite <- (closed_never_leaves D f start kernel F Z).
  apply hit_monotone. intros s Q. unfold unvisited. destruct (visited D s) eqn:V; auto. unfold differ in Q.
  rewrite (followers_agree D g f s G F V), eqb_refl in Q. discriminate.
Qed.

(* The expert itself, at radius zero, for every clone and every data set that it can give. *)
(* label: audit T8(A) *)
Theorem expert_at_radius_zero (D : data) (f : St -> Ac) start kernel :
  possible Pstar (deterministic expert) D -> is_clone D f -> closed D start kernel ->
  distance_to_clone (markov start kernel) H (deterministic expert) (deterministic f) = 0.
Proof.
  intros P C Z. apply closed_distance_zero with D; auto.
  - apply (clone_follows Pstar expert); auto.
  - apply (expert_follows Pstar); auto.
Qed.

End ZeroRadius.

(* Both states were visited, so that every estimate is closed. *)
Section Examples.

Let D : list (trajectory two two) := [[(true, true); (true, true)]; [(false, true); (false, true)]].
Let clone := first_action (St := two) (Ac := two) false D.

Lemma both_possible : possible small (deterministic keep) D.
Proof.
  intros t [<-|[<-|[]]]; unfold trajectory_law; cbn [prob step run]; unfold run_step; simpl;
    unfold dirac_mass; simpl; lra.
Qed.

Lemma clone_of_both : is_clone D clone.
Proof. apply (first_action_clones small keep false D both_possible). Qed.

Lemma estimate_closed : closed D fair wrong_kernel.
Proof.
  assert (forall s, visited D s = true) as V by (intros []; reflexivity).
  split; intros; rewrite V in *; discriminate.
Qed.

Example distance_by_unvisited_mass_nonvacuous :
  distance_to_clone estimated 3 (deterministic keep) (deterministic clone)
  <= sqrt (hit estimated (deterministic clone) 3 (unvisited D)).
Proof. apply distance_by_unvisited_mass with small; [apply both_possible|apply clone_of_both]. Qed.

Example closed_distance_zero_nonvacuous :
  distance_to_clone estimated 3 (deterministic keep) (deterministic clone) = 0.
Proof. apply closed_distance_zero with D; [reflexivity|reflexivity|apply estimate_closed]. Qed.

Example expert_at_radius_zero_nonvacuous :
  distance_to_clone estimated 3 (deterministic keep) (deterministic clone) = 0.
Proof.
  apply expert_at_radius_zero with small D; [apply both_possible|apply clone_of_both|apply estimate_closed].
Qed.

End Examples.
