(* Markov decision processes as data, policies, and the laws of trajectories in both conventions of the horizon.

   A trajectory lists its pairs (state, action), the latest first. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process.
Import ListNotations.
Open Scope R_scope.

Section Mdp.
Context {St Ac : finite}.

Notation trajectory := (list (St * Ac)).

(* The law of the next state given the past; given nothing, of the first state. It may change with time. *)
Definition environment : Type := trajectory -> law St.

(* The law of the action given the past and the present state. *)
Definition policy : Type := trajectory -> St -> law Ac.

(* A Markov decision process with a stationary kernel. *)
Definition markov (start : law St) (kernel : St -> Ac -> law St) : environment :=
  fun h => match h with [] => start | (s, a) :: _ => kernel s a end.

Definition stationary (pi : St -> law Ac) : policy := fun _ s => pi s.
Definition deterministic (f : St -> Ac) : policy := fun _ s => dirac (f s).

Definition run_step (E : environment) (pi : policy) (h : trajectory) (m : St * Ac) : R :=
  E h (fst m) * pi h (fst m) (snd m).

Lemma run_nonneg E pi h m : 0 <= run_step E pi h m.
Proof. apply Rmult_le_pos; apply mass_nonneg. Qed.

Lemma run_total E pi h : sum (run_step E pi h) (elements (pairs St Ac)) = 1.
Proof.
  change (elements (pairs St Ac)) with (list_prod (elements St) (elements Ac)). rewrite sum_list_prod.
  rewrite <- (mass_total (E h)). apply sum_ext. intros s _. unfold run_step; simpl.
  rewrite sum_scal, mass_total. ring.
Qed.

(* The trajectory as a process. *)
Definition run (E : environment) (pi : policy) : process (St * Ac) :=
  Process (elements (pairs St Ac)) (run_step E pi) (run_nonneg E pi) (run_total E pi).

(* Trajectories of H states, each with its action: the convention of the main text, with H - 1 transitions. *)
Definition trajectories (H : nat) : list trajectory := histories (elements (pairs St Ac)) H.

Definition trajectory_law (E : environment) (pi : policy) : trajectory -> R := prob (run E pi).

(* Trajectories whose last arrival is recorded: H transitions, as in the appendix. *)
Definition arrivals (H : nat) : list (trajectory * St) := list_prod (trajectories H) (elements St).

Definition arrival_law (E : environment) (pi : policy) (t : trajectory * St) : R :=
  trajectory_law E pi (fst t) * E (fst t) (snd t).

(* The product of the environment's factors, and that of the policy's. *)
Fixpoint dynamics_factor (E : environment) (t : trajectory) : R :=
  match t with
  | [] => 1
  | (s, _) :: past => dynamics_factor E past * E past s
  end.

Fixpoint policy_factor (pi : policy) (t : trajectory) : R :=
  match t with
  | [] => 1
  | (s, a) :: past => policy_factor pi past * pi past s a
  end.

Theorem factorisation E pi t : trajectory_law E pi t = dynamics_factor E t * policy_factor pi t.
Proof.
  unfold trajectory_law. induction t as [|[s a] t IH]; simpl; [ring|]. rewrite IH. unfold run_step; simpl. ring.
Qed.

Lemma trajectory_law_nonneg E pi t : 0 <= trajectory_law E pi t.
Proof. apply prob_nonneg. Qed.

Theorem trajectory_law_total E pi H : sum (trajectory_law E pi) (trajectories H) = 1.
Proof. apply (prob_total (run E pi)). Qed.

Lemma arrival_law_nonneg E pi t : 0 <= arrival_law E pi t.
Proof. apply Rmult_le_pos; [apply trajectory_law_nonneg|apply mass_nonneg]. Qed.

Theorem arrival_law_total E pi H : sum (arrival_law E pi) (arrivals H) = 1.
Proof.
  unfold arrivals. rewrite sum_list_prod, <- (trajectory_law_total E pi H). apply sum_ext. intros t _.
  unfold arrival_law; simpl. rewrite sum_scal, mass_total. ring.
Qed.

Lemma dynamics_factor_nonneg E t : 0 <= dynamics_factor E t.
Proof. induction t as [|[s a] t IH]; simpl; [lra|]. apply Rmult_le_pos; auto. apply mass_nonneg. Qed.

Lemma policy_factor_nonneg pi t : 0 <= policy_factor pi t.
Proof. induction t as [|[s a] t IH]; simpl; [lra|]. apply Rmult_le_pos; auto. apply mass_nonneg. Qed.

(* Expectation of a function of the trajectory. *)
Definition mean (E : environment) (pi : policy) (H : nat) (f : trajectory -> R) : R := expect (run E pi) H f.

(* Does a trajectory meet a state of a set? *)
Definition visits (D : St -> bool) (t : trajectory) : bool := existsb (fun m => D (fst m)) t.

(* A deterministic policy took every action of the trajectory. *)
Definition follows (f : St -> Ac) (t : trajectory) : bool := forallb (fun m => eqb (snd m) (f (fst m))) t.

Lemma deterministic_factor f t : policy_factor (deterministic f) t = indicator (follows f t).
Proof.
  induction t as [|[s a] t IH]; simpl; auto. rewrite IH. unfold dirac_mass.
  destruct (follows f t), (eqb a (f s)); simpl; ring.
Qed.

(* Independent demonstrations of a policy: a data set lists trajectories. *)
Definition demonstrations (E : environment) (pi : policy) (H : nat) : process trajectory :=
  independent (trajectories H) (trajectory_law E pi) (trajectory_law_nonneg E pi) (trajectory_law_total E pi H).

Definition possible (E : environment) (pi : policy) (D : list trajectory) : Prop :=
  forall t, In t D -> 0 < trajectory_law E pi t.

Lemma possible_data E pi H D : 0 < prob (demonstrations E pi H) D -> possible E pi D.
Proof.
  unfold demonstrations. rewrite prob_independent. intros L t I.
  destruct (trajectory_law_nonneg E pi t) as [Q|Z]; auto. exfalso.
  assert (product (trajectory_law E pi) D = 0); [|lra].
  clear L. induction D as [|u D IH]; [destruct I|]. simpl. destruct I as [->|I]; [rewrite <- Z; ring|].
  rewrite IH by auto. ring.
Qed.

Lemma demonstration_length E pi H n D t :
  In D (histories (outcomes (demonstrations E pi H)) n) -> In t D -> In t (trajectories H).
Proof. intros I J. apply (histories_outcomes (demonstrations E pi H) n D t I J). Qed.

(* Data of a deterministic expert follow it. *)
Lemma possible_follows E f t : 0 < trajectory_law E (deterministic f) t -> follows f t = true.
Proof.
  rewrite factorisation, deterministic_factor. intros L. destruct (follows f t); auto. simpl in L. lra.
Qed.

Lemma follows_pair f t s a : follows f t = true -> In (s, a) t -> a = f s.
Proof.
  unfold follows. rewrite forallb_forall. intros Q I. specialize (Q _ I). apply eqb_true in Q. exact Q.
Qed.

Definition trajectory_same (t u : trajectory) : {t = u} + {t <> u} := list_eq_dec (pair_same St Ac) t u.

End Mdp.

Arguments environment : clear implicits.
Arguments policy : clear implicits.
Notation trajectory St Ac := (list (carrier St * carrier Ac)).
