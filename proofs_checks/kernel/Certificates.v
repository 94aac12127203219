(* Certificates of what is left to gain, checked without trust in an optimiser (certified answers, G2 to G4).

   The set C of a history are the weights whose log-likelihood reaches a level; G1 says when the truth is in it. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Logistic Bridge.Sessions.
Import ListNotations.
Open Scope R_scope.

Section Certificates.
Context {Q : Type} (d : nat) (x : Q -> vector).

(* Weights are taken from a convex set with support function s, such as the ball of radius W. *)
Variables (weights : vector -> Prop) (s : vector -> R).
Hypothesis support : supports d s weights.

Notation history := (list (Q * answer)).

Definition plausible (level : R) (h : history) (w : vector) : Prop :=
  weights w /\ level <= log_likelihood d x w h.

(* Directions in which the weights are known not to point down, with their multipliers. *)
Fixpoint combination (cone : list (R * vector)) : vector :=
  match cone with
  | [] => zero
  | (mu, u) :: rest => add (scale mu u) (combination rest)
  end.

Lemma combination_nonneg cone w :
  (forall mu u, In (mu, u) cone -> 0 <= mu /\ 0 <= dot d u w) -> 0 <= dot d (combination cone) w.
Proof.
  induction cone as [|[mu u] cone IH]; intros Pc; simpl; [rewrite dot_zero; lra|].
  rewrite dot_add, dot_scale. destruct (Pc mu u) as [A B]; [simpl; auto|].
  assert (0 <= mu * dot d u w) by (apply Rmult_le_pos; auto).
  assert (0 <= dot d (combination cone) w) by (apply IH; intros; apply Pc; simpl; auto). lra.
Qed.

(* The bound of G2 for direction v, from a point w0, a multiplier c and multipliers of the cone. *)
Definition dual_bound (level : R) (h : history) (v w0 : vector) (c : R) (cone : list (R * vector)) : R :=
  c * (log_likelihood d x w0 h - dot d (gradient d x w0 h) w0 - level)
  + s (add (add v (combination cone)) (scale c (gradient d x w0 h))).

(* label: companion G2 *)
Theorem dual_certificate level h v w0 c cone w :
  plausible level h w -> 0 <= c ->
  (forall mu u, In (mu, u) cone -> 0 <= mu /\ 0 <= dot d u w) ->
  dot d v w <= dual_bound level h v w0 c cone.
Proof.
  intros [I L] Pc Pm. unfold dual_bound.
  pose proof (support (add (add v (combination cone)) (scale c (gradient d x w0 h))) w I) as B.
  rewrite !dot_add, dot_scale in B. pose proof (combination_nonneg cone w Pm).
  pose proof (log_likelihood_tangent d x w w0 h) as T. rewrite dot_minus_r in T.
  assert (0 <= c * (log_likelihood d x w0 h - dot d (gradient d x w0 h) w0 - level + dot d (gradient d x w0 h) w)).
  { apply Rmult_le_pos; lra. }
  lra.
Qed.

(* G4: a certificate that no weight of the set is plausible. *)
(* label: companion G4 *)
Theorem empty_set_certificate level h w0 c :
  0 <= c -> dual_bound level h zero w0 c [] < 0 -> forall w, ~ plausible level h w.
Proof.
  intros Pc B w P. pose proof (dual_certificate level h zero w0 c [] w P Pc) as D.
  rewrite dot_zero in D. assert (0 <= dual_bound level h zero w0 c []) by (apply D; intros ? ? []). lra.
Qed.

(* Candidates with their expected features, and the utility that the teacher's weights give to them. *)
Context {C : Type} (candidates : list C) (phi : C -> vector) (wstar : vector).

Definition utility (pi : C) : R := dot d (phi pi) wstar.
Definition best (pi : C) : Prop := forall pi', In pi' candidates -> utility pi' <= utility pi.

(* Every remaining contender has a bound in its direction; its cone says that it is best among all candidates. *)
Definition certified (level : R) (h : history) (remaining : list C) (direction : C -> vector) (eps : R) : Prop :=
  forall pi, In pi remaining ->
    exists (w0 : vector) (c : R) (mus : list (R * C)),
      0 <= c /\ (forall mu pi', In (mu, pi') mus -> 0 <= mu /\ In pi' candidates)
      /\ dual_bound level h (direction pi) w0 c
           (map (fun m => (fst m, minus (phi pi) (phi (snd m)))) mus) <= eps.

Lemma certified_direction level h remaining direction eps pi :
  plausible level h wstar -> In pi remaining -> best pi ->
  certified level h remaining direction eps -> dot d (direction pi) wstar <= eps.
Proof.
  intros P I B K. destruct (K pi I) as [w0 [c [mus [Pc [Pm L]]]]].
  eapply Rle_trans; [|exact L]. apply dual_certificate; auto.
  intros mu u J. apply in_map_iff in J. destruct J as [[m pi'] [E J]]. simpl in E. inversion E; subst.
  destruct (Pm _ _ J) as [Q0 Q1]. split; auto. rewrite dot_minus. specialize (B pi' Q1).
  unfold utility in B. lra.
Qed.

(* G3: the recommendation is within eps of the best candidate. *)
(* label: companion G3 *)
Theorem certified_gap level h remaining recommended eps pistar :
  plausible level h wstar -> In pistar remaining -> best pistar ->
  certified level h remaining (fun pi => minus (phi pi) (phi recommended)) eps ->
  utility pistar - utility recommended <= eps.
Proof.
  intros P I B K. pose proof (certified_direction _ _ _ _ _ pistar P I B K) as D.
  cbv beta in D. rewrite dot_minus in D. exact D.
Qed.

(* G3': what is left to gain is at most rho times what has been gained over a reference. *)
Definition share_direction (recommended reference : C) (rho : R) (pi : C) : vector :=
  minus (minus (phi pi) (phi recommended)) (scale rho (minus (phi recommended) (phi reference))).

(* label: companion G3' *)
Theorem certified_share level h remaining recommended reference rho pistar :
  plausible level h wstar -> In pistar remaining -> best pistar -> 0 < rho ->
  certified level h remaining (share_direction recommended reference rho) 0 ->
  utility pistar - utility recommended <= rho * (utility recommended - utility reference)
  /\ / (1 + rho) * (utility pistar - utility reference) <= utility recommended - utility reference.
Proof.
  intros P I B Pr K. pose proof (certified_direction _ _ _ _ _ pistar P I B K) as D.
  unfold share_direction in D. rewrite !dot_minus, dot_scale, dot_minus in D. unfold utility. split; [lra|].
  apply Rmult_le_reg_l with (1 + rho); [lra|]. rewrite <- Rmult_assoc, Rinv_r by lra. lra.
Qed.

End Certificates.

(* G2 for the ball of radius W, without cones: the formula of the text. *)
(* label: companion G2 *)
Theorem dual_certificate_ball {Q : Type} d (x : Q -> vector) W level h v w0 c w :
  norm d w <= W -> level <= log_likelihood d x w h -> 0 <= c ->
  dot d v w <= c * (log_likelihood d x w0 h - dot d (gradient d x w0 h) w0 - level)
               + W * norm d (add v (scale c (gradient d x w0 h))).
Proof.
  intros B L Pc.
  pose proof (dual_certificate d x (ball d W) (fun u => W * norm d u) (ball_supports d W) level h v w0 c [] w) as D.
  unfold dual_bound in D; simpl in D.
  assert (E : norm d (add (add v zero) (scale c (gradient d x w0 h))) = norm d (add v (scale c (gradient d x w0 h)))).
  { unfold norm, dot. f_equal. apply sum_ext. intros i _. unfold add, zero. ring. }
  rewrite E in D. apply D; auto. split; auto. intros ? ? [].
Qed.

(* One answer about one question, in one dimension and the ball of radius 1. *)
Section Examples.

Let x (_ : unit) : vector := one_dimension.
Let h : list (unit * answer) := [(tt, First)].

Lemma unit_weight : ball 1 1 one_dimension.
Proof.
  unfold ball, norm, dot, one_dimension; simpl. replace (1 * 1 + 0) with 1 by ring. rewrite sqrt_1. lra.
Qed.

Lemma unit_position : position 1 x one_dimension tt = 1.
Proof. unfold position, dot, x, one_dimension; simpl. ring. Qed.

Lemma answer_plausible : - 2 <= log_likelihood 1 x one_dimension h.
Proof.
  unfold log_likelihood, likelihood, h; cbn [evidence model]. rewrite unit_position, Rmult_1_l.
  rewrite <- (ln_exp (- 2)). pose proof (exp_pos (- (1))) as P1. pose proof (one_plus_le_exp 1) as P2.
  assert (exp (- (1)) * exp 1 = 1) as P3 by (rewrite <- exp_plus, Rplus_opp_l; apply exp_0).
  assert (exp (- 2) = exp (- (1)) * exp (- (1))) as P4 by (rewrite <- exp_plus; f_equal; ring).
  left. apply ln_increasing; [apply exp_pos|]. unfold logistic.
  apply Rmult_lt_reg_r with (1 + exp (- (1))); [lra|]. rewrite Rinv_l by lra. rewrite P4.
  assert (exp (- (1)) <= / 2) by nra. nra.
Qed.

Example dual_certificate_nonvacuous :
  dot 1 one_dimension one_dimension
  <= dual_bound 1 x (fun u => 1 * norm 1 u) (- 2) h one_dimension zero 1 [(1, one_dimension)].
Proof.
  apply dual_certificate with (weights := ball 1 1); try lra.
  - apply ball_supports.
  - split; [apply unit_weight|apply answer_plausible].
  - intros mu u [Em|[]]. inversion Em; subst. split; [lra|]. apply dot_self_nonneg.
Qed.

Example dual_certificate_ball_nonvacuous :
  dot 1 one_dimension one_dimension
  <= 1 * (log_likelihood 1 x zero h - dot 1 (gradient 1 x zero h) zero - - 2)
     + 1 * norm 1 (add one_dimension (scale 1 (gradient 1 x zero h))).
Proof. apply dual_certificate_ball; [apply unit_weight|apply answer_plausible|lra]. Qed.

(* A level of 1 is above every log-likelihood. *)
Example empty_set_certificate_nonvacuous :
  ~ plausible 1 x (ball 1 1) 1 [] zero.
Proof.
  apply empty_set_certificate with (s := fun u => 1 * norm 1 u) (w0 := zero) (c := 1); try lra.
  - apply ball_supports.
  - unfold dual_bound, log_likelihood, likelihood, dot, norm, add, scale, zero; simpl.
    unfold dot, zero; simpl. rewrite ln_1.
      match goal with |- context [sqrt ?r] => replace r with 0 by ring end. rewrite sqrt_0. lra.
Qed.

Let phi (pi : bool) : vector := if pi then one_dimension else zero.

Lemma true_is_best : best 1 [true; false] phi one_dimension true.
Proof. intros [] _; unfold utility, phi, dot, one_dimension, zero; simpl; lra. Qed.

Lemma bound_without_answers v : dual_bound 1 x (fun u => 1 * norm 1 u) (- 2) h v zero 0 [] = Rabs (v 0%nat).
Proof.
  unfold dual_bound, norm, dot, add, scale, zero; simpl. unfold dot; simpl.
  match goal with |- _ + _ * sqrt ?r = _ => replace r with (Rsqr (v 0%nat)) by (unfold Rsqr, zero; ring) end.
  rewrite sqrt_Rsqr_abs. ring.
Qed.

Example certified_gap_nonvacuous :
  utility 1 phi one_dimension true - utility 1 phi one_dimension false <= 1.
Proof.
  apply certified_gap with (x := x) (weights := ball 1 1) (s := fun u => 1 * norm 1 u) (candidates := [true; false])
    (level := - 2) (h := h) (remaining := [true; false]); simpl; auto.
  - apply ball_supports.
  - split; [apply unit_weight|apply answer_plausible].
  - apply true_is_best.
  - intros pi _. exists zero, 0, []. split; [lra|]. split; [intros ? ? []|].
    cbn [map]. rewrite bound_without_answers. unfold minus, phi, one_dimension, zero.
    destruct pi; rewrite Rabs_pos_eq; lra.
Qed.

(* The cone says that the first candidate is the better one, and nothing is left to gain. *)
Example certified_share_nonvacuous :
  utility 1 phi one_dimension true - utility 1 phi one_dimension true
    <= 1 * (utility 1 phi one_dimension true - utility 1 phi one_dimension false)
  /\ / (1 + 1) * (utility 1 phi one_dimension true - utility 1 phi one_dimension false)
    <= utility 1 phi one_dimension true - utility 1 phi one_dimension false.
Proof.
  apply certified_share with (x := x) (weights := ball 1 1) (s := fun u => 1 * norm 1 u) (candidates := [true; false])
    (level := - 2) (h := h) (remaining := [true]); simpl; auto; try lra.
  - apply ball_supports.
  - split; [apply unit_weight|apply answer_plausible].
  - apply true_is_best.
  - intros pi [<-|[]]. exists zero, 0, [(1, false)]. split; [lra|]. split.
    + intros mu pi' [Em|[]]. inversion Em; subst. split; [lra|simpl; auto].
    + unfold dual_bound, norm, dot, share_direction, minus, add, scale, zero, phi, one_dimension; simpl.
      unfold dot; simpl. match goal with |- _ + _ * sqrt ?r <=
        _ => replace r with 0 by (unfold add, scale, zero; ring) end. rewrite sqrt_0. lra.
Qed.

End Examples.
