(* Sums over lists, Cauchy-Schwarz, and what they need of the real numbers. *)
Require Import Reals List Lra.
Import ListNotations.
Open Scope R_scope.

Fixpoint sum {A : Type} (f : A -> R) (l : list A) : R :=
  match l with
  | [] => 0
  | x :: rest => f x + sum f rest
  end.

Section Sums.
Context {A : Type}.
Implicit Types (f g : A -> R) (l : list A).

Lemma sum_ext f g l : (forall x, In x l -> f x = g x) -> sum f l = sum g l.
Proof.
  induction l as [|x l IH]; intros H; simpl; auto.
  rewrite (H x), IH; auto with *.
Qed.

Lemma sum_plus f g l : sum (fun x => f x + g x) l = sum f l + sum g l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_scal c f l : sum (fun x => c * f x) l = c * sum f l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_le f g l : (forall x, In x l -> f x <= g x) -> sum f l <= sum g l.
Proof.
  induction l as [|x l IH]; intros H; simpl; [lra|].
  apply Rplus_le_compat; auto with *.
Qed.

Lemma sum_nonneg f l : (forall x, In x l -> 0 <= f x) -> 0 <= sum f l.
Proof.
  induction l as [|x l IH]; intros H; simpl; [lra|].
  assert (0 <= f x) by auto with *.
  assert (0 <= sum f l) by auto with *.
  lra.
Qed.

Lemma sum_app f l m : sum f (l ++ m) = sum f l + sum f m.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma square_nonneg x : 0 <= x * x.
Proof. apply Rle_0_sqr. Qed.

Lemma cross_term a b s x y :
  0 <= a -> 0 <= b -> s * s <= a * b -> 2 * s * (x * y) <= a * (y * y) + b * (x * x).
Proof.
  intros Ha Hb Hs.
  destruct (Req_dec a 0) as [Za|Na].
  - assert (s = 0).
    { apply Rsqr_0_uniq. unfold Rsqr. rewrite Za in Hs.
      assert (0 <= s * s) by apply square_nonneg. lra. }
    subst. assert (0 <= b * (x * x)) by (apply Rmult_le_pos; [lra|apply square_nonneg]). lra.
  - assert (Pa : 0 < a) by lra.
    assert (0 <= a * (a * (y * y) + b * (x * x) - 2 * s * (x * y))).
    { replace (a * (a * (y * y) + b * (x * x) - 2 * s * (x * y)))
        with ((a * y - s * x) * (a * y - s * x) + (a * b - s * s) * (x * x)) by ring.
      apply Rplus_le_le_0_compat; [apply square_nonneg|].
      apply Rmult_le_pos; [lra|apply square_nonneg]. }
    assert (0 <= a * (y * y) + b * (x * x) - 2 * s * (x * y)).
    { apply Rmult_le_reg_l with a; lra. }
    lra.
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
  pose proof (cross_term a b s (f x) (g x) ltac:(auto) ltac:(auto) IH).
  nra.
Qed.

Lemma sum_abs f l : Rabs (sum f l) <= sum (fun x => Rabs (f x)) l.
Proof.
  induction l as [|x l IH]; simpl; [rewrite Rabs_R0; lra|].
  eapply Rle_trans; [apply Rabs_triang|lra].
Qed.

End Sums.

Lemma sum_map {A B : Type} (h : A -> B) (f : B -> R) l : sum f (map h l) = sum (fun x => f (h x)) l.
Proof. induction l as [|x l IH]; simpl; [|rewrite IH]; lra. Qed.

Lemma sum_flat_map {A B : Type} (h : A -> list B) (f : B -> R) l :
  sum f (flat_map h l) = sum (fun x => sum f (h x)) l.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite sum_app, IH. lra. Qed.

Lemma sum_swap {A B : Type} (f : A -> B -> R) l m :
  sum (fun x => sum (f x) m) l = sum (fun y => sum (fun x => f x y) l) m.
Proof.
  induction l as [|x l IH]; simpl.
  - induction m; simpl; lra.
  - rewrite IH, <- sum_plus. reflexivity.
Qed.

Lemma square_le x y : 0 <= y -> x * x <= y * y -> x <= y.
Proof. intros Hy H. apply Rsqr_incr_0_var; unfold Rsqr; auto. Qed.
