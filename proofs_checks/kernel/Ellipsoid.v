(* Containment and regret in an ellipsoid of weights (the audit's R2 and R4), given the event that the truth is in it.

   V = v I + sum of x x' over the observed differences acts through its bilinear form;
     z stands for V^-1 m where its form
   with every u is <m, u>, so that the norm of m in V^-1 is the root of <m, z>. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Logistic.
Import ListNotations.
Open Scope R_scope.

Section Form.
Variables (d : nat) (v : R) (xs : list vector).
Hypothesis v_pos : 0 < v.

Definition form (u w : vector) : R := v * dot d u w + sum (fun x => dot d x u * dot d x w) xs.

Definition form_norm (u : vector) : R := sqrt (form u u).

Lemma form_sym u w : form u w = form w u.
Proof. unfold form. rewrite dot_sym. f_equal. apply sum_ext. intros; ring. Qed.

Lemma form_nonneg u : 0 <= form u u.
Proof.
  unfold form. pose proof (dot_self_nonneg d u).
  assert (0 <= sum (fun x => dot d x u * dot d x u) xs) by (apply sum_nonneg; intros; apply square_nonneg). nra.
Qed.

(* The coordinates of a vector under a root of V. *)
Definition coordinate (u : vector) (k : nat + vector) : R :=
  match k with inl i => sqrt v * u i | inr x => dot d x u end.

Lemma form_as_sum u w :
  form u w = sum (fun k => coordinate u k * coordinate w k) (map inl (seq 0 d) ++ map inr xs).
Proof.
  rewrite sum_app, !sum_map. unfold form; cbn [coordinate]. f_equal. unfold dot. rewrite <- sum_scal.
  apply sum_ext. intros i _. replace (sqrt v * u i * (sqrt v * w i)) with (sqrt v * sqrt v * (u i * w i)) by ring.
  rewrite sqrt_sqrt by lra. reflexivity.
Qed.

Lemma form_cauchy_schwarz u w : form u w <= form_norm u * form_norm w.
Proof.
  apply square_le; [apply Rmult_le_pos; apply sqrt_pos|]. unfold form_norm.
  replace (sqrt (form u u) * sqrt (form w w) * (sqrt (form u u) * sqrt (form w w)))
    with ((sqrt (form u u) * sqrt (form u u)) * (sqrt (form w w) * sqrt (form w w))) by ring.
  rewrite !sqrt_sqrt by apply form_nonneg. rewrite !form_as_sum.
  apply (cauchy_schwarz (coordinate u) (coordinate w)).
Qed.

(* V^-1, by any solver of linear equations. *)
Variable solve : vector -> vector.
Hypothesis solves : forall m u, form (solve m) u = dot d m u.

Definition inverse_norm (m : vector) : R := sqrt (dot d m (solve m)).

Lemma dot_by_norms m u : dot d m u <= inverse_norm m * form_norm u.
Proof.
  rewrite <- (solves m u). eapply Rle_trans; [apply form_cauchy_schwarz|]. right. f_equal.
  unfold form_norm, inverse_norm. rewrite solves. reflexivity.
Qed.

Lemma inverse_norm_of_opposite m m' : (forall u, dot d m' u = - dot d m u) -> inverse_norm m' = inverse_norm m.
Proof.
  intros O. unfold inverse_norm. f_equal. rewrite O.
  rewrite <- (solves m (solve m')), form_sym, solves, O. ring.
Qed.

(* A round: a centre, a width, candidates that remain, and the pair that is played. *)
Context {C : Type} (remaining : list C) (phi : C -> vector) (wstar centre : vector) (rho : R).
Hypothesis truth_in : form_norm (minus wstar centre) <= rho.

Definition width (a b : C) : R := rho * inverse_norm (minus (phi a) (phi b)).

Definition contained (a : C) : Prop :=
  In a remaining /\ forall b, In b remaining -> 0 <= dot d (minus (phi a) (phi b)) centre + width a b.

Lemma by_width a b : dot d (minus (phi a) (phi b)) wstar <= dot d (minus (phi a) (phi b)) centre + width a b.
Proof.
  pose proof (dot_by_norms (minus (phi a) (phi b)) (minus wstar centre)) as Q. rewrite dot_minus_r in Q.
  pose proof (sqrt_pos (dot d (minus (phi a) (phi b)) (solve (minus (phi a) (phi b))))) as N0.
  fold (inverse_norm (minus (phi a) (phi b))) in N0. unfold width. nra.
Qed.

(* label: audit R2 *)
Theorem best_policy_is_contained a : In a remaining ->
  (forall b, In b remaining -> dot d (phi b) wstar <= dot d (phi a) wstar) -> contained a.
Proof.
  intros I B. split; auto. intros b J. eapply Rle_trans; [|apply by_width]. rewrite dot_minus.
  specialize (B b J). lra.
Qed.

Lemma width_sym a b : width a b = width b a.
Proof. unfold width. f_equal. apply inverse_norm_of_opposite. intros. rewrite !dot_minus. ring. Qed.

(* label: audit R4(ii) *)
Theorem regret_of_round best a b : contained best -> contained a -> contained b ->
  (forall p q, contained p -> contained q -> width p q <= width a b) ->
  dot d (phi best) wstar - (dot d (phi a) wstar + dot d (phi b) wstar) / 2 <= 2 * width a b.
Proof.
  intros K Ka Kb W.
  assert (Q : forall c, contained c -> dot d (phi best) wstar - dot d (phi c) wstar <= 2 * width a b).
  { intros c Kc. pose proof (by_width best c) as B1. destruct Kc as [Ic Kc]. destruct K as [Ib Kb'].
    pose proof (Kc best Ib) as B2. pose proof (W best c (conj Ib Kb') (conj Ic Kc)) as B3.
    rewrite (width_sym c best) in B2. rewrite !dot_minus in *. lra. }
  pose proof (Q a Ka). pose proof (Q b Kb). lra.
Qed.

(* R4(iii): the sum of all rounds at once, in the direction m, by the set after the last of them. *)
(* label: audit R4(iii) *)
Theorem regret_in_hindsight m : dot d m wstar <= dot d m centre + rho * inverse_norm m.
Proof.
  pose proof (dot_by_norms m (minus wstar centre)) as Q. rewrite dot_minus_r in Q.
  pose proof (sqrt_pos (dot d m (solve m))) as N0. fold (inverse_norm m) in N0. nra.
Qed.

End Form.

(* One dimension, one observed difference of 1, and v = 1: V is 2. *)
Section Examples.

Let one : vector := fun _ => 1.
Let half (m : vector) : vector := scale (/ 2) m.
Let phi (c : bool) : vector := if c then one else zero.

Lemma half_solves m u : form 1 1 [one] (half m) u = dot 1 m u.
Proof. unfold form, half, dot, scale, one; simpl. field. Qed.

Lemma one_within : form_norm 1 1 [one] (minus one zero) <= 2.
Proof.
  replace 2 with (sqrt (2 * 2)) by (apply sqrt_square; lra). apply sqrt_le_1_alt.
  unfold form, dot, minus, one, zero; simpl. lra.
Qed.

Lemma true_contained : contained 1 half [true; false] phi zero 2 true.
Proof.
  apply (best_policy_is_contained 1 1 [one] ltac:(lra) half half_solves [true; false] phi one zero 2 one_within).
  - simpl; auto.
  - intros [] _; unfold dot, phi, one, zero; simpl; lra.
Qed.

Example best_policy_is_contained_nonvacuous : contained 1 half [true; false] phi zero 2 true.
Proof.
  apply (best_policy_is_contained 1 1 [one] ltac:(lra) half half_solves [true; false] phi one zero 2 one_within).
  - simpl; auto.
  - intros [] _; unfold dot, phi, one, zero; simpl; lra.
Qed.

Lemma false_contained : contained 1 half [true; false] phi zero 2 false.
Proof.
  split; [simpl; auto|]. intros b _. unfold width.
  replace (dot 1 (minus (phi false) (phi b)) zero) with 0 by (unfold dot, zero; simpl; ring).
  pose proof (sqrt_pos (dot 1 (minus (phi false) (phi b)) (half (minus (phi false) (phi b))))).
  unfold inverse_norm. lra.
Qed.

Lemma widest p q : width 1 half phi 2 p q <= width 1 half phi 2 true false.
Proof.
  unfold width, inverse_norm. apply Rmult_le_compat_l; [lra|]. apply sqrt_le_1_alt.
  destruct p, q; unfold dot, half, scale, minus, phi, one, zero; simpl; lra.
Qed.

Example regret_of_round_nonvacuous :
  dot 1 (phi true) one - (dot 1 (phi true) one + dot 1 (phi false) one) / 2 <= 2 * width 1 half phi 2 true false.
Proof.
  apply (regret_of_round 1 1 [one] ltac:(lra) half half_solves [true; false] phi one zero 2 one_within);
    auto using true_contained, false_contained. intros; apply widest.
Qed.

Example regret_in_hindsight_nonvacuous : dot 1 one one <= dot 1 one zero + 2 * inverse_norm 1 half one.
Proof. apply (regret_in_hindsight 1 1 [one] ltac:(lra) half half_solves one zero 2 one_within). Qed.

End Examples.
