(* A lattice cover of probability rows and of kernels (the audit's T11). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

(* Numbers c with a given total on a list, as functions that vanish outside of it. *)
Section Compositions.
Context {X : finite}.

Definition raise (x : X) (c : X -> nat) : X -> nat := fun y => if same X y x then S (c y) else c y.

Fixpoint compositions (l : list X) (total : nat) : list (X -> nat) :=
  match l with
  | [] => match total with O => [fun _ => O] | S _ => [] end
  | x :: rest =>
      (fix raised (k : nat) : list (X -> nat) :=
         compositions rest k ++ match k with O => [] | S j => map (raise x) (raised j) end) total
  end.

Lemma compositions_zero x l : compositions (x :: l) 0 = compositions l 0 ++ [].
Proof. reflexivity. Qed.

Lemma compositions_step x l k :
  compositions (x :: l) (S k) = compositions l (S k) ++ map (raise x) (compositions (x :: l) k).
Proof. reflexivity. Qed.

Definition total (c : X -> nat) (l : list X) : nat := fold_right (fun x n => (c x + n)%nat) O l.

Lemma INR_total c l : INR (total c l) = sum (fun x => INR (c x)) l.
Proof. induction l as [|x l IH]; simpl; auto. rewrite plus_INR, IH. reflexivity. Qed.

Lemma total_ext c c' l : (forall x, In x l -> c x = c' x) -> total c l = total c' l.
Proof. induction l as [|x l IH]; intros Q; simpl; auto. rewrite (Q x), IH; auto with *. Qed.

Lemma raise_total x c l : NoDup l -> In x l -> total (raise x c) l = S (total c l).
Proof.
  induction l as [|y l IH]; intros D I; [destruct I|]. inversion D; subst. cbn [total fold_right].
  fold (total (raise x c) l) (total c l). unfold raise at 1. destruct (same X y x) as [E|E].
  - subst. rewrite (total_ext (raise x c) c l); [lia|]. intros z J. unfold raise.
    destruct (same X z x); auto. subst. contradiction.
  - destruct I as [I|I]; [congruence|]. rewrite IH by auto. lia.
Qed.

Lemma compositions_vanish l : forall k c y, In c (compositions l k) -> ~ In y l -> c y = O.
Proof.
  induction l as [|x l IHl]; intros k c y I N.
  - destruct k; simpl in I; [destruct I as [<-|[]]; reflexivity|destruct I].
  - revert c I. induction k as [|k IHk]; intros c I.
    + rewrite compositions_zero, app_nil_r in I. apply (IHl 0%nat c y I). intros J. apply N. right; auto.
    + rewrite compositions_step in I. apply in_app_or in I. destruct I as [I|I].
      * apply (IHl (S k) c y I). intros J. apply N. right; auto.
      * apply in_map_iff in I. destruct I as [c0 [<- I]]. unfold raise. destruct (same X y x) as [->|].
        -- destruct N. left; reflexivity.
        -- apply IHk; auto.
Qed.

(* Their number is a binomial coefficient: Pascal's recursion is that of the enumeration. *)
Lemma C_itself n : C n n = 1.
Proof.
  unfold C. rewrite Nat.sub_diag. pose proof (INR_fact_neq_0 n). simpl (fact 0). simpl (INR 1). field; auto.
Qed.

Lemma C_nothing n : C n 0 = 1.
Proof.
  unfold C. rewrite Nat.sub_0_r. pose proof (INR_fact_neq_0 n). simpl (fact 0). simpl (INR 1). field; auto.
Qed.

Lemma compositions_number x l k : INR (length (compositions (x :: l) k)) = C (length l + k) (length l).
Proof.
  revert x k. induction l as [|y l IHl]; intros x k.
  - rewrite C_nothing. induction k as [|k IHk]; [reflexivity|]. rewrite compositions_step.
    rewrite app_length, map_length, plus_INR, IHk. simpl. ring.
  - induction k as [|k IHk].
    + rewrite compositions_zero, app_nil_r, IHl. cbn [length]. rewrite <- !plus_n_O, !C_itself. reflexivity.
    + rewrite compositions_step, app_length, map_length, plus_INR, IHk, IHl. cbn [length].
      replace (S (length l) + k)%nat with (length l + S k)%nat by lia.
      replace (S (length l) + S k)%nat with (S (length l + S k)) by lia. apply pascal. lia.
Qed.

(* Every function with the total is one of them, on the list. *)
Lemma compositions_complete l k c : NoDup l -> total c l = k ->
  exists c', In c' (compositions l k) /\ forall x, In x l -> c' x = c x.
Proof.
  revert k c. induction l as [|x l IHl]; intros k c D T.
  - simpl in T. subst k. exists (fun _ => O). split; [left; reflexivity|]. intros ? [].
  - inversion D as [|? ? N D']; subst. remember (total c (x :: l)) as k eqn:Tk. revert c Tk.
    induction k as [|k IHk]; intros c Tk.
    + destruct (IHl 0%nat c D') as [c0 [I Q]]; [simpl in Tk; fold (total c l) in Tk; lia|].
      exists c0. rewrite compositions_zero, app_nil_r. split; auto.
      intros y [->|J]; auto. assert (c y = O) as -> by (simpl in Tk; lia).
      apply (compositions_vanish l 0 c0 y I N).
    + destruct (c x) as [|m] eqn:Ex.
      * destruct (IHl (S k) c D') as [c0 [I Q]]; [simpl in Tk; fold (total c l) in Tk; lia|].
        exists c0. rewrite compositions_step. split; [apply in_or_app; auto|].
        intros y [->|J]; auto. rewrite Ex. apply (compositions_vanish l (S k) c0 y I N).
      * set (c1 := fun y => if same X y x then m else c y).
        assert (total c1 (x :: l) = k) as T1.
        { cbn [total fold_right] in *. fold (total c l) in Tk. fold (total c1 l).
          rewrite (total_ext c1 c l).
          - unfold c1. destruct (same X x x); [lia|congruence].
          - intros z J. unfold c1. destruct (same X z x); auto. subst; contradiction. }
        destruct (IHk c1 (eq_sym T1)) as [c0 [I Q]].
        exists (raise x c0). rewrite compositions_step. split.
        -- apply in_or_app. right. apply in_map. exact I.
        -- intros y J. unfold raise. rewrite (Q y J). unfold c1. destruct (same X y x); [subst; auto|auto].
Qed.

End Compositions.

(* Rounding up. *)
Definition round_up (x : R) : nat := Z.to_nat (1 - up (- x)).

Lemma round_up_range x : 0 <= x -> x <= INR (round_up x) < x + 1.
Proof.
  intros P. destruct (archimed (- x)) as [A B].
  assert (IZR (1 - up (- x)) = 1 - IZR (up (- x))) as E by (rewrite minus_IZR; reflexivity).
  assert (0 <= 1 - up (- x))%Z as Q.
  { apply le_IZR. rewrite E. lra. }
  unfold round_up. rewrite INR_IZR_INZ, Z2Nat.id by auto. rewrite E. lra.
Qed.

Section Rows.
Context {X : finite} (other : X).

Notation size := (size X).

Lemma size_positive : (0 < size)%nat.
Proof.
  unfold Sums.size. pose proof (complete X other). destruct (elements X); [contradiction|simpl; lia].
Qed.

(* Integers at least m p, with total m + size - 1. *)
Lemma lattice_point (p : law X) m : (0 < m)%nat ->
  exists c : X -> nat, total c (elements X) = (m + size - 1)%nat /\ forall x, INR m * p x <= INR (c x).
Proof.
  intros Pm. set (c := fun x => round_up (INR m * p x)).
  assert (R0 : forall x, INR m * p x <= INR (c x) < INR m * p x + 1).
  { intros x. apply round_up_range. apply Rmult_le_pos; [apply pos_INR|apply mass_nonneg]. }
  assert (T : INR (total c (elements X)) < INR (m + size)).
  { rewrite INR_total, plus_INR. unfold Sums.size.
    replace (INR m + INR (length (elements X))) with (sum (fun x => INR m * p x + 1) (elements X)).
    - pose proof size_positive as S0. unfold Sums.size in S0. revert S0. generalize (elements X) as l.
      induction l as [|x l IH]; simpl; intros L; [lia|]. specialize (R0 x) as Rx.
      destruct l as [|y l]; [simpl; lra|]. assert (0 < length (y :: l))%nat as Ly by (simpl; lia).
      specialize (IH Ly). lra.
    - rewrite sum_plus, sum_scal, sum_const, mass_total. ring. }
  apply INR_lt in T.
  set (gap := (m + size - 1 - total c (elements X))%nat).
  exists (fun x => if same X x other then (c x + gap)%nat else c x). split.
  - assert (Q : forall g c, total (fun x => if same X x other then (c x + g)%nat else c x) (elements X)
      = (total c (elements X) + g)%nat).
    { induction g as [|g IH]; intros c1.
      - rewrite <- plus_n_O. apply total_ext. intros x _. destruct (same X x other); lia.
      - rewrite <- plus_n_Sm, <- IH. rewrite <- raise_total with (x := other); [|apply distinct|apply complete].
        apply total_ext. intros x _. unfold raise. destruct (same X x other); [lia|reflexivity]. }
    rewrite Q. unfold gap. lia.
  - intros x. specialize (R0 x). destruct (same X x other); [rewrite plus_INR; pose proof (pos_INR gap)|]; lra.
Qed.

Definition lattice_mass (c : X -> nat) (x : X) : R :=
  match total c (elements X) with
  | O => dirac_mass other x
  | S _ => INR (c x) / INR (total c (elements X))
  end.

Definition lattice (c : X -> nat) : law X.
Proof.
  refine (Law X (lattice_mass c) _ _).
  - intros x. unfold lattice_mass. destruct (total c (elements X)) as [|k]; [apply dirac_nonneg|].
    unfold Rdiv. apply Rmult_le_pos; [apply pos_INR|]. left. apply Rinv_0_lt_compat, lt_0_INR. lia.
  - unfold lattice_mass. destruct (total c (elements X)) as [|k] eqn:E; [apply dirac_total|].
    unfold Rdiv. rewrite sum_scal_r, <- INR_total, E. apply Rinv_r. apply not_0_INR. lia.
Defined.

Definition row_cover (m : nat) : list (law X) := map lattice (compositions (elements X) (m + size - 1)).

Lemma row_cover_number m : (0 < m)%nat -> INR (length (row_cover m)) = C (m + 2 * size - 2) (size - 1).
Proof.
  intros Pm. unfold row_cover. rewrite map_length. unfold Sums.size. pose proof size_positive as S0.
  unfold Sums.size in S0. destruct (elements X) as [|x l]; [simpl in S0; lia|]. rewrite compositions_number.
  cbn [length]. f_equal; lia.
Qed.

Lemma row_cover_dominates m (p : law X) : (0 < m)%nat ->
  exists q, In q (row_cover m) /\ forall x, p x <= (1 + (INR size - 1) / INR m) * q x.
Proof.
  intros Pm. pose proof (lt_0_INR m Pm) as Pm'. destruct (lattice_point p m Pm) as [c [T Q]].
  destruct (compositions_complete (elements X) _ c (distinct X) T) as [c' [I E]].
  exists (lattice c'). split; [apply in_map; auto|]. intros x. simpl. unfold lattice_mass.
  assert (total c' (elements X) = (m + size - 1)%nat) as T'.
  { rewrite <- T. apply total_ext. intros; apply E; auto. }
  pose proof size_positive as S0. rewrite T'. destruct (m + size - 1)%nat as [|k] eqn:Ek; [lia|].
  rewrite <- Ek, (E x) by apply complete.
  assert (INR (m + size - 1) = INR m + INR size - 1) as Ei.
  { rewrite minus_INR, plus_INR by lia. simpl. ring. }
  rewrite Ei. apply le_INR in S0. simpl in S0. specialize (Q x).
  replace ((1 + (INR size - 1) / INR m) * (INR (c x) / (INR m + INR size - 1))) with (INR (c x) / INR m)
    by (field; lra).
  apply Rmult_le_reg_r with (INR m); auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

End Rows.

(* Kernels: a row for each element of an index, all choices of rows of the cover. *)
Section Kernels.
Context {I X : finite} (other : X).

Fixpoint choices {A : Type} (l : list I) (rows : list A) (some : A) : list (I -> A) :=
  match l with
  | [] => [fun _ => some]
  | i :: rest => flat_map (fun f => map (fun q j => if same I j i then q else f j) rows) (choices rest rows some)
  end.

Lemma flat_map_number {A B D : Type} (g : A -> B -> D) (fs : list A) (rows : list B) :
  INR (length (flat_map (fun f => map (g f) rows) fs)) = INR (length rows) * INR (length fs).
Proof.
  induction fs as [|f fs IH]; [simpl; ring|]. cbn [flat_map length].
  rewrite app_length, plus_INR, IH, map_length, S_INR. ring.
Qed.

Lemma choices_number {A : Type} l (rows : list A) some :
  INR (length (choices l rows some)) = INR (length rows) ^ length l.
Proof.
  induction l as [|i l IH]; [reflexivity|]. cbn [choices length]. rewrite <- tech_pow_Rmult, <- IH.
  apply (flat_map_number (fun f q j => if same I j i then q else f j)).
Qed.

Lemma choices_complete {A : Type} l (rows : list A) some (good : I -> A -> Prop) :
  (forall i, exists q, In q rows /\ good i q) ->
  exists f, In f (choices l rows some) /\ forall i, In i l -> good i (f i).
Proof.
  intros Q. induction l as [|i l [f [J G]]].
  - exists (fun _ => some). split; [left; reflexivity|]. intros ? [].
  - destruct (Q i) as [q [Jq Gq]]. exists (fun j => if same I j i then q else f j). split.
    + apply in_flat_map. exists f. split; auto. apply in_map_iff. exists q. auto.
    + intros j [->|K]; [destruct (same I j j); congruence|]. destruct (same I j i); [subst; auto|auto].
Qed.

Definition kernel_cover (m : nat) : list (I -> law X) := choices (elements I) (row_cover other m) (dirac other).

(* T11: the lattice cover with denominators m + size - 1, its number, and its precision. *)
(* label: audit T11 *)
Theorem lattice_covers_kernels m : (0 < m)%nat ->
  INR (length (kernel_cover m)) = C (m + 2 * size X - 2) (size X - 1) ^ size I
  /\ forall P : I -> law X, exists Q, In Q (kernel_cover m)
       /\ forall i x, P i x <= (1 + (INR (size X) - 1) / INR m) * Q i x.
Proof.
  intros Pm. split.
  - unfold kernel_cover. rewrite choices_number, row_cover_number by auto. reflexivity.
  - intros P. destruct (choices_complete (elements I) (row_cover other m) (dirac other)
      (fun i q => forall x, P i x <= (1 + (INR (size X) - 1) / INR m) * q x)) as [Q [J G]].
    + intros i. apply row_cover_dominates; auto.
    + exists Q. split; auto. intros i x. apply G, complete.
Qed.

(* The same at a given precision: any integer m from (size - 1) / (e^epsilon - 1) on will do. *)
(* label: audit T11 *)
Theorem lattice_cover_at_precision epsilon m : 0 < epsilon -> (0 < m)%nat ->
  (INR (size X) - 1) / (exp epsilon - 1) <= INR m ->
  INR (length (kernel_cover m)) = C (m + 2 * size X - 2) (size X - 1) ^ size I
  /\ forall P : I -> law X, exists Q, In Q (kernel_cover m) /\ forall i x, P i x <= exp epsilon * Q i x.
Proof.
  intros Pe Pm L. destruct (lattice_covers_kernels m Pm) as [N A]. split; auto. intros P.
  destruct (A P) as [Q [J G]]. exists Q. split; auto. intros i x. eapply Rle_trans; [apply G|].
  apply Rmult_le_compat_r; [apply mass_nonneg|]. pose proof (lt_0_INR m Pm) as Pm'.
  assert (0 < exp epsilon - 1) as Px.
  { pose proof (exp_increasing 0 epsilon Pe) as Y. rewrite exp_0 in Y. lra. }
  assert ((INR (size X) - 1) / INR m <= exp epsilon - 1); [|lra].
  apply Rmult_le_reg_r with (INR m); auto. unfold Rdiv at 1. rewrite Rmult_assoc, Rinv_l by lra.
  assert ((INR (size X) - 1) / (exp epsilon - 1) * (exp epsilon - 1) <= INR m * (exp epsilon - 1)) as Z
    by (apply Rmult_le_compat_r; lra).
  unfold Rdiv in Z. rewrite Rmult_assoc, Rinv_l in Z by lra. lra.
Qed.

End Kernels.

Example lattice_covers_kernels_nonvacuous :
  INR (length (kernel_cover (I := pairs two two) (X :=
    two) true 5)) = C (5 + 2 * size two - 2) (size two - 1) ^ size (pairs two two)
  /\ forall P : pairs two two -> law two, exists Q, In Q (kernel_cover (true : two) 5)
       /\ forall i x, P i x <= (1 + (INR (size two) - 1) / INR 5) * Q i x.
Proof. apply lattice_covers_kernels. lia. Qed.

Example lattice_cover_at_precision_nonvacuous :
  INR (length (kernel_cover (I := pairs two two) (X :=
    two) true 1)) = C (1 + 2 * size two - 2) (size two - 1) ^ size (pairs two two)
  /\ forall P : pairs two two -> law two, exists Q, In Q (kernel_cover (true : two) 1)
       /\ forall i x, P i x <= exp 1 * Q i x.
Proof.
  apply lattice_cover_at_precision; [lra|lia|]. unfold size; simpl. pose proof (one_plus_le_exp 1).
  replace (1 + 1 - 1) with 1 by ring. apply Rmult_le_reg_r with (exp 1 - 1); [lra|].
  unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.
