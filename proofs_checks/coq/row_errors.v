(* T4, one step: the row errors average at most u (2 - u) under the first marginal, u the squared distance of the pair.

   Points x of the first variable with laws p, q, and the overlap r x = 1 - h x of the rows at x. *)
Require Import Reals List Lra.
Require Import Bridge.finite_sums.
Import ListNotations.
Open Scope R_scope.

Section Rows.
Context {A : Type} (l : list A) (p q h : A -> R).
Hypothesis p_nonneg : forall x, In x l -> 0 <= p x.
Hypothesis q_nonneg : forall x, In x l -> 0 <= q x.
Hypothesis p_total : sum p l = 1.
Hypothesis q_total : sum q l = 1.
Hypothesis h_range : forall x, In x l -> 0 <= h x <= 1.

Definition overlap : R := sum (fun x => sqrt (p x * q x) * (1 - h x)) l.
Definition u : R := 1 - overlap.

Theorem row_error_at_step : sum (fun x => p x * h x) l <= u * (2 - u).
Proof.
  assert (overlap * overlap <= 1 - sum (fun x => p x * h x) l) as H.
  { pose proof (cauchy_schwarz (fun x => sqrt (q x)) (fun x => sqrt (p x) * (1 - h x)) l) as CS.
    cbv beta in CS.
    assert (sum (fun x => sqrt (q x) * (sqrt (p x) * (1 - h x))) l = overlap) as E.
    { unfold overlap. apply sum_ext. intros x Hx. rewrite sqrt_mult by auto. ring. }
    assert (sum (fun x => sqrt (q x) * sqrt (q x)) l = 1) as Q.
    { rewrite <- q_total. apply sum_ext. intros x Hx. apply sqrt_sqrt; auto. }
    assert (sum (fun x => sqrt (p x) * (1 - h x) * (sqrt (p x) * (1 - h x))) l
      <= 1 - sum (fun x => p x * h x) l) as P.
    { replace (1 - sum (fun x => p x * h x) l) with (sum p l + (-1) * sum (fun x => p x * h x) l) by lra.
      rewrite <- sum_scal, <- sum_plus. apply sum_le. intros x Hx.
      replace (sqrt (p x) * (1 - h x) * (sqrt (p x) * (1 - h x)))
        with ((sqrt (p x) * sqrt (p x)) * ((1 - h x) * (1 - h x))) by ring.
      rewrite sqrt_sqrt by auto. pose proof (p_nonneg x Hx). pose proof (h_range x Hx).
      assert ((1 - h x) * (1 - h x) <= 1 - h x) by nra.
      nra. }
    rewrite E, Q in CS. lra. }
  unfold u. nra.
Qed.

End Rows.
