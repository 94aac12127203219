(* The recursion for overlaps of trajectory laws: X_{t+1}(s') = sum_s X_t(s) M(s, s') sums all trajectories.

   p s a s' and q s a s' are the one-step probabilities pi(a|s) P(s'|s,a) of two (policy, kernel) pairs. A trajectory
   from s is a list of (action, next state). *)
Require Import Reals List Lra Lia.
Require Import Bridge.finite_sums.
Import ListNotations.
Open Scope R_scope.

Section Paths.
Context {St Ac : Type} (states : list St) (actions : list Ac) (p q : St -> Ac -> St -> R) (start : St -> R).
Hypothesis p_nonneg : forall s a s', 0 <= p s a s'.
Hypothesis q_nonneg : forall s a s', 0 <= q s a s'.

Definition moves : list (Ac * St) := list_prod actions states.

Fixpoint paths (n : nat) : list (list (Ac * St)) :=
  match n with
  | O => [[]]
  | S k => flat_map (fun move => map (cons move) (paths k)) moves
  end.

Fixpoint weight (r : St -> Ac -> St -> R) (s : St) (path : list (Ac * St)) : R :=
  match path with
  | [] => 1
  | (a, s') :: rest => r s a s' * weight r s' rest
  end.

Definition M (s s' : St) : R := sum (fun a => sqrt (p s a s' * q s a s')) actions.

Fixpoint X (n : nat) (s' : St) : R :=
  match n with
  | O => start s'
  | S k => sum (fun s => X k s * M s s') states
  end.

(* Overlap of what follows a state: the recursion read backwards. *)
Fixpoint Y (n : nat) (s : St) : R :=
  match n with
  | O => 1
  | S k => sum (fun s' => M s s' * Y k s') states
  end.

Lemma weight_nonneg r s path : (forall s a s', 0 <= r s a s') -> 0 <= weight r s path.
Proof.
  intros H. revert s. induction path as [|[a s'] path IH]; intros s; simpl; [lra|].
  apply Rmult_le_pos; auto.
Qed.

Lemma sum_list_prod (f : Ac -> St -> R) (l : list Ac) (k : list St) :
  sum (fun move => f (fst move) (snd move)) (list_prod l k) = sum (fun a => sum (f a) k) l.
Proof.
  induction l as [|a l IH]; simpl; [lra|]. rewrite sum_app, sum_map, IH. simpl. reflexivity.
Qed.

Lemma overlap_after s n :
  sum (fun path => sqrt (weight p s path * weight q s path)) (paths n) = Y n s.
Proof.
  revert s. induction n as [|n IH]; intros s; simpl.
  - replace (1 * 1) with 1 by ring. rewrite sqrt_1. lra.
  - rewrite sum_flat_map.
    transitivity (sum (fun move => sqrt (p s (fst move) (snd move) * q s (fst move) (snd move)) * Y n (snd move)) moves).
    + apply sum_ext. intros [a s'] _. rewrite sum_map. rewrite <- IH, <- sum_scal.
      apply sum_ext. intros path _. simpl.
      replace (p s a s' * weight p s' path * (q s a s' * weight q s' path))
        with ((p s a s' * q s a s') * (weight p s' path * weight q s' path)) by ring.
      apply sqrt_mult; apply Rmult_le_pos; auto; apply weight_nonneg; auto.
    + unfold moves. rewrite (sum_list_prod (fun a s' => sqrt (p s a s' * q s a s') * Y n s')).
      rewrite sum_swap. apply sum_ext. intros s' _. unfold M.
      rewrite Rmult_comm, <- sum_scal. apply sum_ext. intros. ring.
Qed.

Lemma forward_and_backward n k :
  sum (fun s => X n s * Y (S k) s) states = sum (fun s => X (S n) s * Y k s) states.
Proof.
  simpl.
  transitivity (sum (fun s => sum (fun s' => X n s * M s s' * Y k s') states) states).
  - apply sum_ext. intros s _. rewrite <- sum_scal. apply sum_ext. intros. ring.
  - rewrite sum_swap. apply sum_ext. intros s' _.
    rewrite Rmult_comm, <- sum_scal. apply sum_ext. intros. ring.
Qed.

Theorem agreement_recursion n :
  sum (fun s => sum (fun path => start s * sqrt (weight p s path * weight q s path)) (paths n)) states
  = sum (X n) states.
Proof.
  transitivity (sum (fun s => X 0 s * Y n s) states).
  - apply sum_ext. intros s _. rewrite sum_scal, overlap_after. reflexivity.
  - assert (forall k m, sum (fun s => X m s * Y k s) states = sum (fun s => X (m + k) s * Y 0 s) states).
    { induction k as [|k IH]; intros m.
      * rewrite <- plus_n_O. reflexivity.
      * rewrite forward_and_backward, IH. replace (S m + k)%nat with (m + S k)%nat by lia. reflexivity. }
    rewrite H. simpl. apply sum_ext. intros. ring.
Qed.

End Paths.
