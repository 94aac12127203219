(* Sums over finite lists, products, Cauchy-Schwarz, finite types and laws on them. *)
Require Import Reals List Lra Lia Bool FinFun.
Import ListNotations.
Open Scope R_scope.

Fixpoint sum {A : Type} (f : A -> R) (l : list A) : R :=
  match l with
  | [] => 0
  | x :: rest => f x + sum f rest
  end.

Fixpoint product {A : Type} (f : A -> R) (l : list A) : R :=
  match l with
  | [] => 1
  | x :: rest => f x * product f rest
  end.

Section Sums.
Context {A : Type}.
Implicit Types (f g : A -> R) (l : list A).

Lemma sum_ext f g l : (forall x, In x l -> f x = g x) -> sum f l = sum g l.
Proof. induction l as [|x l IH]; intros Q; simpl; auto. rewrite (Q x), IH; auto with *. Qed.

Lemma sum_plus f g l : sum (fun x => f x + g x) l = sum f l + sum g l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_minus f g l : sum (fun x => f x - g x) l = sum f l - sum g l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_scal c f l : sum (fun x => c * f x) l = c * sum f l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_scal_r c f l : sum (fun x => f x * c) l = sum f l * c.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_zero l : sum (fun _ => 0) l = 0.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_const c l : sum (fun _ => c) l = INR (length l) * c.
Proof. induction l as [|x l IH]; [simpl; lra|]. cbn [sum length]. rewrite IH, S_INR. lra. Qed.

Lemma sum_le f g l : (forall x, In x l -> f x <= g x) -> sum f l <= sum g l.
Proof. induction l as [|x l IH]; intros Q; simpl; [lra|]. apply Rplus_le_compat; auto with *. Qed.

Lemma sum_nonneg f l : (forall x, In x l -> 0 <= f x) -> 0 <= sum f l.
Proof. intros Q. rewrite <- (sum_zero l). apply sum_le; auto. Qed.

Lemma sum_app f l m : sum f (l ++ m) = sum f l + sum f m.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma term_le_sum f l x : (forall y, In y l -> 0 <= f y) -> In x l -> f x <= sum f l.
Proof.
  induction l as [|y l IH]; intros Q I; [destruct I|]. simpl.
  assert (0 <= f y) by auto with *. assert (0 <= sum f l) by (apply sum_nonneg; auto with *).
  destruct I as [->|I]; [lra|]. assert (f x <= sum f l) by auto with *. lra.
Qed.

Lemma sum_zero_inv f l x : (forall y, In y l -> 0 <= f y) -> sum f l = 0 -> In x l -> f x = 0.
Proof. intros Q Z I. pose proof (term_le_sum f l x Q I). pose proof (Q x I). lra. Qed.

Lemma sum_abs f l : Rabs (sum f l) <= sum (fun x => Rabs (f x)) l.
Proof.
  induction l as [|x l IH]; simpl; [rewrite Rabs_R0; lra|]. eapply Rle_trans; [apply Rabs_triang|lra].
Qed.

Lemma square_nonneg x : 0 <= x * x.
Proof. apply Rle_0_sqr. Qed.

Lemma cross_term a b s x y :
  0 <= a -> 0 <= b -> s * s <= a * b -> 2 * s * (x * y) <= a * (y * y) + b * (x * x).
Proof.
  intros Ha Hb Hs. destruct (Req_dec a 0) as [Za|Na].
  - assert (s = 0).
    { apply Rsqr_0_uniq. unfold Rsqr. rewrite Za in Hs. pose proof (square_nonneg s). lra. }
    subst. assert (0 <= b * (x * x)) by (apply Rmult_le_pos; [lra|apply square_nonneg]). lra.
  - assert (0 <= a * (a * (y * y) + b * (x * x) - 2 * s * (x * y))).
    { replace (a * (a * (y * y) + b * (x * x) - 2 * s * (x * y)))
        with ((a * y - s * x) * (a * y - s * x) + (a * b - s * s) * (x * x)) by ring.
      apply Rplus_le_le_0_compat; [apply square_nonneg|]. apply Rmult_le_pos; [lra|apply square_nonneg]. }
    assert (0 <= a * (y * y) + b * (x * x) - 2 * s * (x * y)) by (apply Rmult_le_reg_l with a; lra). lra.
Qed.

Lemma cauchy_schwarz f g l :
  sum (fun x => f x * g x) l * sum (fun x => f x * g x) l
  <= sum (fun x => f x * f x) l * sum (fun x => g x * g x) l.
Proof.
  induction l as [|x l IH]; simpl; [lra|].
  set (s := sum (fun x => f x * g x) l) in *.
  set (a := sum (fun x => f x * f x) l) in *.
  set (b := sum (fun x => g x * g x) l) in *.
  assert (0 <= a) by (apply sum_nonneg; intros; apply square_nonneg).
  assert (0 <= b) by (apply sum_nonneg; intros; apply square_nonneg).
  pose proof (cross_term a b s (f x) (g x) ltac:(auto) ltac:(auto) IH). nra.
Qed.

Lemma product_nonneg f l : (forall x, In x l -> 0 <= f x) -> 0 <= product f l.
Proof. induction l as [|x l IH]; intros Q; simpl; [lra|]. apply Rmult_le_pos; auto with *. Qed.

Lemma product_pos f l : (forall x, In x l -> 0 < f x) -> 0 < product f l.
Proof. induction l as [|x l IH]; intros Q; simpl; [lra|]. apply Rmult_lt_0_compat; auto with *. Qed.

Lemma product_le f g l : (forall x, In x l -> 0 <= f x <= g x) -> product f l <= product g l.
Proof.
  induction l as [|x l IH]; intros Q; simpl; [lra|].
  apply Rmult_le_compat; auto with *; try apply Q; auto with *. apply product_nonneg. intros; apply Q; auto with *.
Qed.

Lemma product_mult f g l : product (fun x => f x * g x) l = product f l * product g l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma product_ext f g l : (forall x, In x l -> f x = g x) -> product f l = product g l.
Proof. induction l as [|x l IH]; intros Q; simpl; auto. rewrite (Q x), IH; auto with *. Qed.

Lemma product_const c l : product (fun _ => c) l = c ^ length l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma product_app f l m : product f (l ++ m) = product f l * product f m.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

End Sums.

Lemma sum_map {A B : Type} (h : A -> B) (f : B -> R) l : sum f (map h l) = sum (fun x => f (h x)) l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_flat_map {A B : Type} (h : A -> list B) (f : B -> R) l :
  sum f (flat_map h l) = sum (fun x => sum f (h x)) l.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite sum_app, IH. lra. Qed.

Lemma sum_list_prod {A B : Type} (f : A * B -> R) l m :
  sum f (list_prod l m) = sum (fun x => sum (fun y => f (x, y)) m) l.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite sum_app, sum_map, IH. reflexivity. Qed.

Lemma sum_swap {A B : Type} (f : A -> B -> R) l m :
  sum (fun x => sum (f x) m) l = sum (fun y => sum (fun x => f x y) l) m.
Proof.
  induction l as [|x l IH]; simpl; [symmetry; apply sum_zero|]. rewrite IH, <- sum_plus. reflexivity.
Qed.

Lemma square_le x y : 0 <= y -> x * x <= y * y -> x <= y.
Proof. intros Hy Q. apply Rsqr_incr_0_var; unfold Rsqr; auto. Qed.

Definition indicator (b : bool) : R := if b then 1 else 0.

Lemma indicator_range b : 0 <= indicator b <= 1.
Proof. destruct b; simpl; lra. Qed.

(* A finite type: all its elements are listed, each once. *)
Record finite := Finite {
  carrier :> Type;
  elements : list carrier;
  same : forall x y : carrier, {x = y} + {x <> y};
  complete : forall x, In x elements;
  distinct : NoDup elements
}.

Definition size (X : finite) : nat := length (elements X).
Definition eqb {X : finite} (x y : X) : bool := if same X x y then true else false.

Lemma eqb_true {X : finite} (x y : X) : eqb x y = true <-> x = y.
Proof. unfold eqb. destruct (same X x y); split; congruence. Qed.

Lemma eqb_refl {X : finite} (x : X) : eqb x x = true.
Proof. apply eqb_true; reflexivity. Qed.

Lemma eqb_false {X : finite} (x y : X) : eqb x y = false <-> x <> y.
Proof. unfold eqb. destruct (same X x y); split; congruence. Qed.

Lemma sum_at_list {X : finite} (x : X) (f : X -> R) (l : list X) : NoDup l ->
  sum (fun y => indicator (eqb y x) * f y) l = if in_dec (same X) x l then f x else 0.
Proof.
  induction l as [|z l IH]; intros D; [reflexivity|]. inversion D as [|? ? N D']; subst.
  cbn [sum]. rewrite IH by auto. unfold eqb at 1.
  destruct (same X z x) as [E|E]; simpl indicator.
  - subst. destruct (in_dec (same X) x l); [contradiction|].
    destruct (in_dec (same X) x (x :: l)) as [_|N']; [lra|destruct N'; left; auto].
  - destruct (in_dec (same X) x l); destruct (in_dec (same X) x (z :: l)) as [I|I]; try lra.
    + destruct I; right; auto.
    + destruct I; [contradiction|contradiction].
Qed.

Lemma sum_at {X : finite} (x : X) (f : X -> R) :
  sum (fun y => indicator (eqb y x) * f y) (elements X) = f x.
Proof.
  rewrite sum_at_list by apply distinct. destruct (in_dec (same X) x (elements X)) as [_|N]; auto.
  destruct N. apply complete.
Qed.

(* A law on a finite type. *)
Record law (X : finite) := Law {
  mass :> X -> R;
  mass_nonneg : forall x, 0 <= mass x;
  mass_total : sum mass (elements X) = 1
}.
Arguments mass {X}. Arguments mass_nonneg {X}. Arguments mass_total {X}.

Lemma mass_le_one {X : finite} (p : law X) x : p x <= 1.
Proof.
  rewrite <- (mass_total p). apply term_le_sum; [intros; apply mass_nonneg|apply complete].
Qed.

Lemma some_mass {X : finite} (p : law X) : exists x, 0 < p x.
Proof.
  assert (Q : forall l, 0 < sum p l -> exists x, 0 < p x).
  { induction l as [|x l IH]; simpl; intros Q; [lra|].
    destruct (Rle_lt_or_eq_dec 0 (p x) (mass_nonneg p x)) as [L|E]; [exists x; auto|].
    apply IH. rewrite <- E in Q. lra. }
  apply (Q (elements X)). rewrite mass_total. lra.
Qed.

Definition dirac_mass {X : finite} (x y : X) : R := indicator (eqb y x).

Lemma dirac_nonneg {X : finite} (x y : X) : 0 <= dirac_mass x y.
Proof. apply indicator_range. Qed.

Lemma dirac_total {X : finite} (x : X) : sum (dirac_mass x) (elements X) = 1.
Proof.
  rewrite <- (sum_at x (fun _ => 1)). apply sum_ext. intros. unfold dirac_mass. ring.
Qed.

Definition dirac {X : finite} (x : X) : law X :=
  Law X (dirac_mass x) (dirac_nonneg x) (dirac_total x).

(* The pairs of two finite types. *)
Definition pair_same (X Y : finite) (p q : X * Y) : {p = q} + {p <> q}.
Proof. decide equality; apply same. Defined.

Lemma NoDup_list_prod {A B : Type} (l : list A) (m : list B) : NoDup l -> NoDup m -> NoDup (list_prod l m).
Proof.
  intros Dl Dm. induction Dl as [|x l N D IH]; simpl; [constructor|].
  assert (Q : forall (r s : list (A * B)), NoDup r -> NoDup s -> (forall z, In z r -> In z s -> False) ->
    NoDup (r ++ s)).
  { induction r as [|z r IHr]; intros s Dr Ds X; simpl; auto. inversion Dr; subst. constructor.
    - intros I. apply in_app_or in I. destruct I as [I|I]; [contradiction|]. apply (X z); simpl; auto.
    - apply IHr; auto. intros y I J. apply (X y); simpl; auto. }
  apply Q; auto.
  - apply Injective_map_NoDup; auto. intros a b E. congruence.
  - intros [a b] I J. apply in_map_iff in I. destruct I as [c [E _]]. inversion E; subst.
    apply in_prod_iff in J. tauto.
Qed.

Definition pairs (X Y : finite) : finite.
Proof.
  refine (Finite (X * Y) (list_prod (elements X) (elements Y)) (pair_same X Y) _ _).
  - intros [x y]. apply in_prod; apply complete.
  - apply NoDup_list_prod; apply distinct.
Defined.

Lemma sum_pairs {X Y : finite} (f : pairs X Y -> R) :
  sum f (elements (pairs X Y)) = sum (fun x => sum (fun y => f (x, y)) (elements Y)) (elements X).
Proof. apply (sum_list_prod f (elements X) (elements Y)). Qed.

(* Two elements, for examples. *)
Definition two : finite.
Proof.
  refine (Finite bool [true; false] bool_dec _ _).
  - intros []; simpl; auto.
  - repeat constructor; simpl; intuition congruence.
Defined.

Lemma one_plus_le_exp x : 1 + x <= exp x.
Proof. apply exp_ineq1_le. Qed.

Lemma ln_le_minus_one x : 0 < x -> ln x <= x - 1.
Proof. intros P. pose proof (one_plus_le_exp (ln x)). rewrite exp_ln in H by auto. lra. Qed.

Lemma root_mult x y : 0 <= x -> 0 <= y -> sqrt (x * y) = sqrt x * sqrt y.
Proof. intros; apply sqrt_mult; auto. Qed.
