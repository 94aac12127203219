(* Counting the policies within a Hellinger ball by the sets of states where they differ from the clone
  (audit T14). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Deterministic Bridge.Cloning.
Require Import Bridge.Covering Bridge.Small.
Import ListNotations.
Open Scope R_scope.

(* All subsets of a list. *)
Fixpoint subsets {A : Type} (l : list A) : list (list A) :=
  match l with
  | [] => [[]]
  | x :: rest => subsets rest ++ map (cons x) (subsets rest)
  end.

Section Counting.
Context {St Ac : finite} (clone : St -> Ac).

Lemma other_actions (a : Ac) (yes no : R) :
  sum (fun q => if eqb q a then yes else no) (elements Ac) = yes + (INR (size Ac) - 1) * no.
Proof.
  transitivity (sum (fun q => indicator (eqb q a) * (yes - no) + no) (elements Ac)).
  - apply sum_ext. intros q _. destruct (eqb q a); simpl; ring.
  - rewrite sum_plus, (sum_at a (fun _ => yes - no)), sum_const. unfold size. ring.
Qed.

Lemma by_disagreement (l : list St) (some : Ac) (G : list St -> R) : NoDup l ->
  sum (fun f => G (filter (differ f clone) l)) (choices l (elements Ac) some)
  = sum (fun D => (INR (size Ac) - 1) ^ length D * G D) (subsets l).
Proof.
  intros N. revert G. induction N as [|i l N0 N IH]; intros G; [simpl; ring|].
  cbn [choices subsets]. rewrite sum_flat_map, sum_app, sum_map.
  transitivity (sum (fun f => G (filter (differ f clone) l)
    + (INR (size Ac) - 1) * G (i :: filter (differ f clone) l)) (choices l (elements Ac) some)).
  - apply sum_ext. intros f _. rewrite sum_map, <- (other_actions (clone i)). apply sum_ext. intros q _.
    set (f' := fun j => if same St j i then q else f j).
    assert (filter (differ f' clone) l = filter (differ f clone) l) as E.
    { apply filter_ext_in. intros j J. unfold differ, f'. destruct (same St j i) as [->|];
      [contradiction|reflexivity]. }
    cbn [filter]. rewrite E. unfold differ at 1, f'. destruct (same St i i) as [_|X]; [|congruence].
    destruct (eqb q (clone i)); reflexivity.
  - rewrite sum_plus, sum_scal, (IH G), (IH (fun D => G (i :: D))). f_equal. rewrite <- sum_scal.
    apply sum_ext. intros D _. cbn [length pow]. ring.
Qed.

Variables (E : environment St Ac) (H : nat) (radius2 : R).

Definition within (x : R) : bool := if Rle_dec x radius2 then true else false.

(* The number of policies whose squared distance from the clone is at most that of the ball. *)
(* label: audit T14 *)
Theorem policies_in_ball (some : Ac) :
  sum (fun f => indicator (within (hellinger2 (trajectories H) (trajectory_law E (deterministic f))
                                     (trajectory_law E (deterministic clone)))))
    (choices (elements St) (elements Ac) some)
  = sum (fun D => (INR (size Ac) - 1) ^ length D
                  * indicator (within (hit E (deterministic clone) H (member D)))) (subsets (elements St)).
Proof.
  rewrite <- (by_disagreement (elements St) some (fun D => indicator (within (hit E (deterministic clone) H
    (member D)))))
    by apply distinct.
  apply sum_ext. intros f _. f_equal. f_equal.
  destruct (deterministic_distance E H f clone) as [-> _].
  apply Rle_antisym; apply hit_monotone; intros s; unfold member;
    destruct (in_dec (same St) s (filter (differ f clone) (elements St))) as [I|I]; auto.
  - intros Q. destruct I. apply filter_In. split; [apply complete|auto].
  - intros _. apply filter_In in I. tauto.
  - discriminate.
Qed.

End Counting.

Example policies_in_ball_nonvacuous :
  sum (fun f => indicator (within (/ 2) (hellinger2 (trajectories 2) (trajectory_law small (deterministic f))
                                     (trajectory_law small (deterministic keep)))))
    (choices (elements two) (elements two) (true : two))
  = sum (fun D => (INR (size two) - 1) ^ length D
                  * indicator (within (/ 2) (hit small (deterministic keep) 2 (member D)))) (subsets (elements two)).
Proof. apply policies_in_ball. Qed.
