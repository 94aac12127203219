(* A small decision process on which every theorem's premises are met: two states, two actions. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp.
Import ListNotations.
Open Scope R_scope.

(* A law on two elements that gives p to the first. *)
Definition coin_mass (p : R) (b : two) : R := if b : bool then p else 1 - p.

Definition coin (p : R) (range : 0 <= p <= 1) : law two.
Proof.
  refine (Law two (coin_mass p) _ _).
  - intros []; simpl; lra.
  - simpl. lra.
Defined.

Definition fair : law two := coin (/ 2) ltac:(lra).
Definition biased : law two := coin (/ 4) ltac:(lra).

(* Action true keeps the state; action false throws a coin. The estimate takes the coin for a biased one. *)
Definition true_kernel (s a : two) : law two := if a : bool then dirac s else fair.
Definition wrong_kernel (s a : two) : law two := if a : bool then dirac s else biased.

Definition small : environment two two := markov fair true_kernel.
Definition estimated : environment two two := markov fair wrong_kernel.

(* Three policies: the expert, one that differs from it in a state, and one that throws a coin. *)
Definition keep (s : two) : two := true.
Definition stay_in_first (s : two) : two := s.
Definition random_policy : policy two two := fun _ _ => fair.

(* The first component says whether the last action was true. *)
Definition last_action (t : trajectory two two) : nat -> R :=
  fun _ => match t with [] => 0 | (_, a) :: _ => indicator a end.
