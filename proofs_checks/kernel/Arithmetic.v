(* What the formulas of the package need beyond Coq's real numbers; Formulas.v is written over these. *)
From Coq Require Import Reals List Lra Lia ZArith.
Open Scope R_scope.

(* Integers among the reals *)

Definition whole (x : R) : nat := Z.to_nat (Int_part x).
Definition ceiling (x : R) : R := IZR (- Int_part (- x)).

Lemma Int_part_of_IZR (z : Z) : Int_part (IZR z) = z.
Proof.
  destruct (base_Int_part (IZR z)) as [low high].
  apply le_IZR in low.
  assert (reached : IZR z < IZR (Int_part (IZR z) + 1)) by (rewrite plus_IZR; lra).
  apply lt_IZR in reached. lia.
Qed.

Lemma whole_INR (n : nat) : whole (INR n) = n.
Proof. unfold whole. rewrite INR_IZR_INZ, Int_part_of_IZR. apply Nat2Z.id. Qed.

Lemma whole_is (x : R) (n : nat) : x = INR n -> whole x = n.
Proof. intros ->. apply whole_INR. Qed.

Lemma ceiling_at_least (x : R) : x <= ceiling x.
Proof. unfold ceiling. rewrite opp_IZR. destruct (base_Int_part (- x)). lra. Qed.

Lemma ceiling_below (x : R) : ceiling x < x + 1.
Proof. unfold ceiling. rewrite opp_IZR. destruct (base_Int_part (- x)). lra. Qed.

Lemma ceiling_is (x : R) (z : Z) : IZR z - 1 < x <= IZR z -> ceiling x = IZR z.
Proof.
  intros [low high]. pose proof (ceiling_at_least x). pose proof (ceiling_below x).
  unfold ceiling in *. apply f_equal.
  assert (up : IZR (- Int_part (- x)) < IZR (z + 1)) by (rewrite plus_IZR; lra).
  assert (down : IZR z < IZR (- Int_part (- x) + 1)) by (rewrite plus_IZR; lra).
  apply lt_IZR in up. apply lt_IZR in down. lia.
Qed.

(* Branches *)

Definition if_at_most (x y yes no : R) : R := if Rle_dec x y then yes else no.

Lemma if_at_most_yes (x y yes no : R) : x <= y -> if_at_most x y yes no = yes.
Proof. intro. unfold if_at_most. destruct (Rle_dec x y); [reflexivity | contradiction]. Qed.

Lemma if_at_most_no (x y yes no : R) : y < x -> if_at_most x y yes no = no.
Proof. intro. unfold if_at_most. destruct (Rle_dec x y); [lra | reflexivity]. Qed.

(* Binomial coefficients *)

Definition log_binomial (top bottom : R) : R := ln (C (whole top) (whole bottom)).

Lemma C_zero (n : nat) : C n 0 = 1.
Proof. unfold C. rewrite Nat.sub_0_r. simpl (INR (fact 0)). field. apply INR_fact_neq_0. Qed.

Lemma C_step (n k : nat) : (k < n)%nat -> C n (S k) = C n k * (INR n - INR k) / (INR k + 1).
Proof.
  intro below. unfold C. replace (n - k)%nat with (S (n - S k)) by lia.
  rewrite !fact_simpl, !mult_INR, !S_INR, minus_INR by lia. rewrite S_INR.
  pose proof (INR_fact_neq_0 k). pose proof (INR_fact_neq_0 (n - S k)).
  pose proof (pos_INR k). apply lt_INR in below.
  field. repeat split; auto; lra.
Qed.

Lemma log_binomial_INR (n k : nat) : log_binomial (INR n) (INR k) = ln (C n k).
Proof. unfold log_binomial. rewrite !whole_INR. reflexivity. Qed.

(* Sums over tables *)

Fixpoint sum_over {X : Type} (summand : X -> R) (table : list X) : R :=
  match table with
  | nil => 0
  | cell :: rest => summand cell + sum_over summand rest
  end.

Definition sum_over2 {X Y : Type} (summand : X -> Y -> R) (xs : list X) (ys : list Y) : R :=
  sum_over (fun cell => summand (fst cell) (snd cell)) (combine xs ys).

Definition sum_over3 {X Y Z : Type} (summand : X -> Y -> Z -> R) (xs : list X) (ys : list Y) (zs : list Z) : R :=
  sum_over2 (fun x cell => summand x (fst cell) (snd cell)) xs (combine ys zs).

(* The least value, or the greatest lower bound, of a nonnegative function over k = 1, 2, ... *)

Definition minus_a_value (f : nat -> R) (x : R) : Prop := exists k, (1 <= k)%nat /\ x = - Rmax 0 (f k).

Lemma minus_values_bounded (f : nat -> R) : bound (minus_a_value f).
Proof. exists 0. intros x [k [_ ->]]. pose proof (Rmax_l 0 (f k)). lra. Qed.

Lemma minus_values_exist (f : nat -> R) : exists x, minus_a_value f x.
Proof. exists (- Rmax 0 (f 1%nat)). exists 1%nat. auto. Qed.

Definition least_over_positive (f : nat -> R) : R :=
  - proj1_sig (completeness (minus_a_value f) (minus_values_bounded f) (minus_values_exist f)).

Lemma least_at_most (f : nat -> R) (k : nat) : (1 <= k)%nat -> 0 <= f k -> least_over_positive f <= f k.
Proof.
  intros positive nonnegative. unfold least_over_positive.
  destruct (completeness _ _ _) as [top bounds]; cbn [proj1_sig]. destruct bounds as [above _].
  assert (below : - Rmax 0 (f k) <= top) by (apply above; exists k; auto).
  rewrite Rmax_right in below by assumption. lra.
Qed.

Lemma least_at_least (f : nat -> R) (x : R) : (forall k, (1 <= k)%nat -> x <= f k) -> x <= least_over_positive f.
Proof.
  intro lower. unfold least_over_positive.
  destruct (completeness _ _ _) as [top bounds]; cbn [proj1_sig]. destruct bounds as [_ least].
  assert (top <= - x); [apply least | lra].
  intros y [k [positive ->]]. specialize (lower k positive). pose proof (Rmax_r 0 (f k)). lra.
Qed.
