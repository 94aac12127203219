(* Two deterministic policies in one environment
  (the audit's T7 and R8): their distance is the mass of the trajectories on
   which they disagree. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Deterministic.
Context {St Ac : finite}.

(* The probability that a trajectory meets a set of states. *)
Definition hit (E : environment St Ac) (pi : policy St Ac) (H : nat) (A : St -> bool) : R :=
  Pr (run E pi) H (visits A).

Definition differ (f g : St -> Ac) (s : St) : bool := negb (eqb (f s) (g s)).

Lemma visits_none (A : St -> bool) (t : trajectory St Ac) :
  visits A t = false <-> forall s a, In (s, a) t -> A s = false.
Proof.
  unfold visits. split.
  - intros Q s a I. destruct (A s) eqn:F; auto. rewrite <- Q. symmetry. apply existsb_exists. exists (s, a). auto.
  - intros Q. destruct (existsb _ t) eqn:F; auto. apply existsb_exists in F. destruct F as [[s a] [I F]].
    rewrite <- F. apply (Q s a I).
Qed.

Lemma follows_both f g (t : trajectory St Ac) :
  follows f t && follows g t = follows g t && negb (visits (differ f g) t).
Proof.
  induction t as [|[s a] t IH]; [reflexivity|]. cbn [follows visits forallb existsb fst snd] in *.
  unfold follows, visits in *. unfold differ at 1.
  destruct (eqb a (g s)) eqn:Eg; [|rewrite andb_false_r; reflexivity].
  apply eqb_true in Eg. subst a. destruct (eqb (g s) (f s)) eqn:Ef.
  - apply eqb_true in Ef. rewrite Ef, eqb_refl. simpl. exact IH.
  - assert (eqb (f s) (g s) = false) as ->.
    { apply eqb_false. intros Q. rewrite Q, eqb_refl in Ef. discriminate. }
    simpl. rewrite andb_false_r. reflexivity.
Qed.

Lemma common_mass E H f g :
  sum (fun t => dynamics_factor E t * indicator (follows f t && follows g t)) (trajectories H)
  = 1 - hit E (deterministic g) H (differ f g).
Proof.
  unfold hit. rewrite <- (Pr_not (run E (deterministic g)) H (visits (differ f g))). unfold Pr, expect.
  apply sum_ext. intros t _. fold (trajectory_law E (deterministic g) t).
  rewrite factorisation, deterministic_factor, follows_both.
  destruct (follows g t), (visits (differ f g) t); simpl; ring.
Qed.

(* Two deterministic policies in one environment: distance and total variation are the mass of disagreement. *)
(* label: audit T7, R8(a) *)
Theorem deterministic_distance E H (f g : St -> Ac) :
  hellinger2 (trajectories H) (trajectory_law E (deterministic f)) (trajectory_law E (deterministic g))
  = hit E (deterministic g) H (differ f g)
  /\ total_variation (trajectories H) (trajectory_law E (deterministic f)) (trajectory_law E (deterministic g))
  = hit E (deterministic g) H (differ f g).
Proof.
  pose proof (common_mass E H f g) as C. split.
  - unfold hellinger2. replace (hit E (deterministic g) H (differ f g))
      with (1 - sum (fun t => dynamics_factor E t * indicator (follows f t && follows g t)) (trajectories H)) by lra.
    f_equal. apply sum_ext. intros t _. rewrite !factorisation, !deterministic_factor.
    pose proof (dynamics_factor_nonneg E t).
    destruct (follows f t), (follows g t); simpl; rewrite ?Rmult_0_r, ?Rmult_0_l, ?Rmult_1_r, ?sqrt_0; auto.
    apply sqrt_square; auto.
  - unfold total_variation.
    replace (sum (fun t => Rabs (trajectory_law E (deterministic f) t - trajectory_law E (deterministic g) t))
      (trajectories H))
      with (sum (fun t => trajectory_law E (deterministic f) t + trajectory_law E (deterministic g) t
        - 2 * (dynamics_factor E t * indicator (follows f t && follows g t))) (trajectories H)).
    + rewrite sum_minus, sum_plus, sum_scal, !trajectory_law_total, C. field.
    + apply sum_ext. intros t _. rewrite !factorisation, !deterministic_factor.
      pose proof (dynamics_factor_nonneg E t).
      destruct (follows f t), (follows g t); simpl indicator; simpl andb;
        unfold Rabs; destruct (Rcase_abs _); simpl in *; lra.
Qed.

Lemma hit_monotone E pi H (A B : St -> bool) : (forall s, A s = true -> B s = true) -> hit E pi H A <= hit E pi H B.
Proof.
  intros Q. apply Pr_le. intros t _ _ F. apply existsb_exists in F. destruct F as [m [I F]].
  apply existsb_exists. exists m. auto.
Qed.

End Deterministic.

Example deterministic_distance_nonvacuous :
  hellinger2 (trajectories 2) (trajectory_law small (deterministic stay_in_first))
    (trajectory_law small (deterministic keep))
  = hit small (deterministic keep) 2 (differ stay_in_first keep)
  /\ total_variation (trajectories 2) (trajectory_law small (deterministic stay_in_first))
    (trajectory_law small (deterministic keep))
  = hit small (deterministic keep) 2 (differ stay_in_first keep).
Proof. apply deterministic_distance. Qed.
