(* Sessions of preference questions, and the set of weights that their answers leave
  (certified answers, G1 and G4). *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Distances Bridge.Logistic.
Import ListNotations.
Open Scope R_scope.

(* The answer names the preferred trajectory of the pair, or the question is skipped. *)
Inductive answer : Type := First | Second | Skipped.

(* Who asks: a question drawn given everything before, and how probably it is then skipped. The decision to skip sees
   the past and the question, not what would have been answered. A deterministic asker is a special case. *)
Record asker (Q : Type) (questions : list Q) := Asker {
  ask : list (Q * answer) -> Q -> R;
  ask_nonneg : forall h q, 0 <= ask h q;
  ask_total : forall h, sum (ask h) questions = 1;
  skip : list (Q * answer) -> Q -> R;
  skip_range : forall h q, 0 <= skip h q <= 1
}.
Arguments ask {Q questions}. Arguments ask_nonneg {Q questions}. Arguments ask_total {Q questions}.
Arguments skip {Q questions}. Arguments skip_range {Q questions}.

Section Sessions.
Context {Q : Type} (questions : list Q) (d : nat) (x : Q -> vector).

Notation history := (list (Q * answer)).

(* Bradley-Terry: the probability of an answer under weights w, and in a session with skips. *)
Definition position (w : vector) (q : Q) : R := dot d (x q) w.

Definition model (w : vector) (_ : history) (q : Q) (a : answer) : R :=
  match a with
  | First => logistic (position w q)
  | Second => logistic (- position w q)
  | Skipped => 1
  end.

Section Teacher.
Variables (w : vector) (A : asker Q questions).

Definition session_step (h : history) (m : Q * answer) : R :=
  ask A h (fst m) * match snd m with
                    | Skipped => skip A h (fst m)
                    | a => (1 - skip A h (fst m)) * model w h (fst m) a
                    end.

Lemma session_nonneg h m : 0 <= session_step h m.
Proof.
  destruct m as [q a]. unfold session_step; cbn [fst snd]. pose proof (ask_nonneg A h q).
  pose proof (skip_range A h q). apply Rmult_le_pos; auto.
  destruct a; simpl; try lra; apply Rmult_le_pos; try lra; left; apply logistic_pos.
Qed.

Definition answers : list answer := [First; Second; Skipped].

Lemma session_total h : sum (session_step h) (list_prod questions answers) = 1.
Proof.
  rewrite sum_list_prod, <- (ask_total A h). apply sum_ext. intros q _.
  unfold session_step, answers; cbn [sum fst snd model].
  pose proof (logistic_total (position w q)).
  replace (logistic (- position w q)) with (1 - logistic (position w q)) by lra. ring.
Qed.

(* The session of a teacher whose weights are w. *)
Definition session : process (Q * answer) :=
  Process (list_prod questions answers) session_step session_nonneg session_total.

End Teacher.

(* A forecast of the next answer, made from the past and the question. *)
Definition forecast : Type := history -> Q -> answer -> R.

Definition honest (f : forecast) : Prop :=
  forall h q, 0 <= f h q First /\ 0 <= f h q Second /\ f h q First + f h q Second <= 1.

(* What a forecast gave to the answers that came; skips count for nothing. *)
Fixpoint evidence (f : forecast) (h : history) : R :=
  match h with
  | [] => 1
  | (q, a) :: past => evidence f past * match a with Skipped => 1 | _ => f past q a end
  end.

Definition likelihood (w : vector) (h : history) : R := evidence (model w) h.
Definition log_likelihood (w : vector) (h : history) : R := ln (likelihood w h).

Lemma model_pos w h q a : 0 < model w h q a.
Proof. destruct a; simpl; try lra; apply logistic_pos. Qed.

Lemma model_honest w : honest (model w).
Proof.
  intros h q. pose proof (model_pos w h q First). pose proof (model_pos w h q Second).
  pose proof (logistic_total (position w q)). simpl in *. repeat split; lra.
Qed.

Lemma likelihood_pos w h : 0 < likelihood w h.
Proof.
  unfold likelihood. induction h as [|[q a] h IH]; simpl; [lra|]. apply Rmult_lt_0_compat; auto.
  destruct a; try lra; apply (model_pos w h q First) || apply (model_pos w h q Second).
Qed.

Lemma evidence_nonneg f h : honest f -> 0 <= evidence f h.
Proof.
  intros O. induction h as [|[q a] h IH]; simpl; [lra|]. apply Rmult_le_pos; auto.
  destruct (O h q) as [? [? ?]]. destruct a; auto. lra.
Qed.

(* Forecasters k with prior weights nu, fixed before the first answer: a weight vector is one of them. *)
Section Mixture.
Context {K : Type} (forecasters : list K) (nu : K -> R) (f : K -> forecast).
Hypothesis nu_nonneg : forall k, In k forecasters -> 0 <= nu k.
Hypothesis nu_total : sum nu forecasters = 1.
Hypothesis f_honest : forall k, In k forecasters -> honest (f k).

Definition mixture (h : history) : R := sum (fun k => nu k * evidence (f k) h) forecasters.

Lemma mixture_nonneg h : 0 <= mixture h.
Proof. apply sum_nonneg. intros k I. apply Rmult_le_pos; auto. apply evidence_nonneg; auto. Qed.

(* The martingale step: the answers' probabilities cancel against the likelihood of the truth. *)
Lemma one_answer w A h q : 
  sum (fun a => session_step w A h (q, a) * (mixture ((q, a) :: h) / likelihood w ((q, a) :: h))) answers
  <= ask A h q * (mixture h / likelihood w h).
Proof.
  pose proof (likelihood_pos w h) as PL. pose proof (ask_nonneg A h q) as PA. pose proof (skip_range A h q) as PS.
  pose proof (model_pos w h q First) as P1. pose proof (model_pos w h q Second) as P2.
  assert (E : sum (fun a => session_step w A h (q, a) * (mixture ((q, a) :: h) / likelihood w ((q, a) :: h))) answers
    = ask A h q / likelihood w h * (skip A h q * mixture h
      + (1 - skip A h q) * (mixture ((q, First) :: h) + mixture ((q, Second) :: h)))).
  { assert (mixture ((q, Skipped) :: h) = mixture h) as Es.
    { apply sum_ext. intros k _. simpl. ring. }
    unfold answers; cbn [sum]. rewrite Es. unfold session_step; cbn [fst snd].
    assert (El : forall a, likelihood w
      ((q, a) :: h) = likelihood w h * match a with Skipped => 1 | _ => model w h q a end)
      by (intros []; reflexivity).
    rewrite !El. field. lra. }
  rewrite E. unfold Rdiv. rewrite Rmult_assoc. apply Rmult_le_compat_l; auto.
  rewrite Rmult_comm. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; auto|].
  assert (mixture ((q, First) :: h) + mixture ((q, Second) :: h) <= mixture h).
  { unfold mixture. rewrite <- sum_plus. apply sum_le. intros k I. cbn [evidence].
    destruct (f_honest k I h q) as [F1 [F2 F3]]. pose proof (nu_nonneg k I).
    pose proof (evidence_nonneg (f k) h (f_honest k I)).
    replace (nu k * (evidence (f k) h * f k h q First) + nu k * (evidence (f k) h * f k h q Second))
      with (nu k * evidence (f k) h * (f k h q First + f k h q Second)) by ring.
    rewrite <- (Rmult_1_r (nu k * evidence (f k) h)) at 2. apply Rmult_le_compat_l; auto.
    apply Rmult_le_pos; auto. }
  pose proof (mixture_nonneg h). nra.
Qed.

(* G1: whoever asks and skips, at all times at once the truth is at most 1/delta less likely than the mixture. *)
(* label: companion G1 *)
Theorem likelihood_set_covers w A delta n : 0 < delta ->
  with_probability (session w A) (1 - delta) n (always (fun h => delta * mixture h < likelihood w h)).
Proof.
  intros P.
  apply with_probability_impl with (A := always (fun h => delta * (mixture h / likelihood w h) < 1)).
  - intros h _ _. apply always_impl. intros g L. pose proof (likelihood_pos w g) as PL.
    apply Rmult_lt_reg_r with (/ likelihood w g); [apply Rinv_0_lt_compat; auto|].
    rewrite Rinv_r by lra. unfold Rdiv in L. lra.
  - apply ville; auto.
    + intros h. apply Rmult_le_pos; [apply mixture_nonneg|left; apply Rinv_0_lt_compat, likelihood_pos].
    + unfold mixture, likelihood; simpl. rewrite sum_scal_r, nu_total. lra.
    + intros h. cbn [step session outcomes]. rewrite sum_list_prod.
      replace (mixture h / likelihood w h)
        with (sum (fun q => ask A h q * (mixture h / likelihood w h)) questions)
        by (rewrite sum_scal_r, ask_total; ring).
      apply sum_le. intros q _. apply one_answer.
Qed.

End Mixture.

(* G1, one forecast, in logarithms: the forecast must not call an answer impossible. *)
Fixpoint log_score (f : forecast) (h : history) : R :=
  match h with
  | [] => 0
  | (q, a) :: past => log_score f past + match a with Skipped => 0 | _ => ln (f past q a) end
  end.

Definition open_minded (f : forecast) : Prop := forall h q, 0 < f h q First /\ 0 < f h q Second.

Lemma evidence_pos f h : open_minded f -> 0 < evidence f h.
Proof.
  intros O. induction h as [|[q a] h IH]; simpl; [lra|]. apply Rmult_lt_0_compat; auto.
  destruct (O h q). destruct a; auto. lra.
Qed.

Lemma log_score_is f h : open_minded f -> log_score f h = ln (evidence f h).
Proof.
  intros O. induction h as [|[q a] h IH]; cbn [log_score evidence]; [symmetry; apply ln_1|].
  destruct (O h q). pose proof (evidence_pos f h O).
  destruct a; rewrite ?ln_mult, IH; auto; try lra. rewrite ln_1; ring.
Qed.

(* label: companion G1 *)
Theorem forecast_bounds_truth w A f delta n : 0 < delta -> honest f -> open_minded f ->
  with_probability (session w A) (1 - delta) n
    (always (fun h => log_likelihood w h >= log_score f h - ln (/ delta))).
Proof.
  intros P O M.
  apply with_probability_impl
    with (A := always (fun h => delta * mixture [tt] (fun _ => 1) (fun _ => f) h < likelihood w h)).
  - intros h _ _. apply always_impl. intros g L. unfold mixture in L; simpl in L.
    rewrite log_score_is by auto. rewrite ln_Rinv by auto. unfold log_likelihood.
    pose proof (evidence_pos f g M).
    assert (ln (delta * evidence f g) < ln (likelihood w g)) as I.
    { apply ln_increasing; [apply Rmult_lt_0_compat; auto|lra]. }
    rewrite ln_mult in I; auto. lra.
  - apply likelihood_set_covers; auto; try (simpl; lra). intros; lra.
Qed.

(* G1': a finite prior nu on weights; every density q, chosen after the answers by any optimiser. *)
(* label: companion G1' *)
Theorem prior_bounds_truth {K : Type} (candidates : list K) (weight : K -> vector) (nu : K -> R) w A delta n :
  0 < delta -> (forall k, In k candidates -> 0 < nu k) -> sum nu candidates = 1 ->
  with_probability (session w A) (1 - delta) n
    (always (fun h => forall q : K -> R, (forall k, In k candidates -> 0 <= q k) -> sum q candidates = 1 ->
       log_likelihood w h >= sum (fun k => q k * log_likelihood (weight k) h) candidates
                             - kl candidates q nu - ln (/ delta))).
Proof.
  intros P Pn T.
  apply with_probability_impl
    with (A := always (fun h => delta * mixture candidates nu (fun k => model (weight k)) h < likelihood w h)).
  - intros h _ _. apply always_impl. intros g L q Pq Tq.
    pose proof (gibbs candidates q nu (fun k => log_likelihood (weight k) g) Pn Pq Tq) as G.
    assert (sum (fun k => nu k * exp (log_likelihood (weight k) g)) candidates
      = mixture candidates nu (fun k => model (weight k)) g) as E.
    { apply sum_ext. intros k _. unfold log_likelihood. rewrite exp_ln by apply likelihood_pos. reflexivity. }
    cbv beta in G. rewrite E in G. rewrite ln_Rinv by auto.
    set (b := sum (fun k => q k * log_likelihood (weight k) g) candidates - kl candidates q nu) in *.
    assert (delta * exp b < likelihood w g) as I.
    { eapply Rle_lt_trans; [|exact L]. apply Rmult_le_compat_l; lra. }
    assert (ln (delta * exp b) < log_likelihood w g) as J.
    { apply ln_increasing; auto. apply Rmult_lt_0_compat; auto. apply exp_pos. }
    rewrite ln_mult, ln_exp in J; auto; [lra|apply exp_pos].
  - apply likelihood_set_covers; auto.
    + intros k I. left; auto.
    + intros; apply model_honest.
Qed.

(* G4: the answers contradict the model where every weight of the set is less likely than delta times the mixture of
   any forecasters, in or out of the model. A true model is contradicted with probability at most delta. *)
(* label: companion G4 *)
Theorem true_model_is_not_refuted {K : Type} (forecasters : list K) (nu : K -> R) (f : K -> forecast)
  (weights : vector -> Prop) w A delta n :
  0 < delta -> weights w ->
  (forall k, In k forecasters -> 0 <= nu k) -> sum nu forecasters = 1 ->
  (forall k, In k forecasters -> honest (f k)) ->
  with_probability (session w A) (1 - delta) n
    (always (fun h => ~ forall v, weights v -> likelihood v h <= delta * mixture forecasters nu f h)).
Proof.
  intros P I Pn T O.
  apply with_probability_impl with (A := always (fun h => delta * mixture forecasters nu f h < likelihood w h)).
  - intros h _ _. apply always_impl. intros g L C. specialize (C w I). lra.
  - apply likelihood_set_covers; auto.
Qed.

(* The gradient of the log-likelihood, and its concavity. *)
Fixpoint gradient (w : vector) (h : history) : vector :=
  match h with
  | [] => zero
  | (q, a) :: past =>
      add (gradient w past)
          (scale match a with
                 | First => logistic (- position w q)
                 | Second => - logistic (position w q)
                 | Skipped => 0
                 end (x q))
  end.

Lemma log_likelihood_tangent w w0 h :
  log_likelihood w h <= log_likelihood w0 h + dot d (gradient w0 h) (minus w w0).
Proof.
  unfold log_likelihood, likelihood. induction h as [|[q a] h IH]; cbn [evidence gradient].
  - rewrite dot_zero. lra.
  - rewrite dot_add, dot_scale. pose proof (likelihood_pos w h) as P. pose proof (likelihood_pos w0 h) as P0.
    unfold likelihood in P, P0.
    assert (E : dot d (x q) (minus w w0) = position w q - position w0 q) by apply dot_minus_r.
    rewrite E. destruct a; cbn [model].
    + rewrite !ln_mult; auto; try apply logistic_pos.
      pose proof (log_logistic_tangent (position w q) (position w0 q)). lra.
    + rewrite !ln_mult; auto; try apply logistic_pos.
      pose proof (log_logistic_tangent (- position w q) (- position w0 q)) as L. rewrite Ropp_involutive in L. lra.
    + rewrite !Rmult_1_r. lra.
Qed.

End Sessions.

(* A session with one question, asked again and again and skipped every fourth time on average. *)
Definition single_asker : asker unit [tt].
Proof.
  refine (Asker unit [tt] (fun _ _ => 1) _ _ (fun _ _ => / 4) _).
  - intros; lra.
  - intros; simpl; lra.
  - intros; lra.
Defined.

Definition one_dimension : vector := fun _ => 1.
Definition even_odds {Q : Type} : forecast (Q := Q) := fun _ _ _ => / 2.
Definition bold {Q : Type} : forecast (Q := Q) := fun _ _ a => match a with First => 1 | _ => 0 end.

Lemma even_odds_honest {Q : Type} : honest (Q := Q) even_odds.
Proof. intros h q. unfold even_odds. lra. Qed.

Lemma bold_honest {Q : Type} : honest (Q := Q) bold.
Proof. intros h q. unfold bold. lra. Qed.

Example likelihood_set_covers_nonvacuous :
  with_probability (session [tt] 1 (fun _ => one_dimension) one_dimension single_asker) (1 - / 20) 10
    (always (fun h => / 20 * mixture [true; false] (fun _ => / 2) (fun k => if k : bool then even_odds else bold) h
                      < likelihood 1 (fun _ => one_dimension) one_dimension h)).
Proof.
  apply likelihood_set_covers; try lra.
  - intros; lra.
  - simpl; lra.
  - intros [] _; [apply even_odds_honest|apply bold_honest].
Qed.

Example forecast_bounds_truth_nonvacuous :
  with_probability (session [tt] 1 (fun _ => one_dimension) one_dimension single_asker) (1 - / 20) 10
    (always (fun h => log_likelihood 1 (fun _ => one_dimension) one_dimension h
                      >= log_score even_odds h - ln (/ / 20))).
Proof.
  apply forecast_bounds_truth; try lra; [apply even_odds_honest|]. intros h q. unfold even_odds. lra.
Qed.

Example prior_bounds_truth_nonvacuous :
  with_probability (session [tt] 1 (fun _ => one_dimension) one_dimension single_asker) (1 - / 20) 10
    (always (fun h => log_likelihood 1 (fun _ => one_dimension) one_dimension h
       >= sum (fun k => / 2 * log_likelihood 1 (fun _ => one_dimension) (fun _ => k) h) [0; 1]
          - kl [0; 1] (fun _ => / 2) (fun k => if Rle_dec k 0 then / 4 else 3 / 4) - ln (/ / 20))).
Proof.
  eapply with_probability_impl; [|apply prior_bounds_truth with
    (candidates := [0; 1]) (weight := fun k _ => k) (nu := fun k => if Rle_dec k 0 then / 4 else 3 / 4)].
  - intros h _ _. apply always_impl. intros g L. apply (L (fun _ => / 2)); [intros; lra|simpl; lra].
  - lra.
  - intros k _. destruct (Rle_dec k 0); lra.
  - simpl. destruct (Rle_dec 0 0); destruct (Rle_dec 1 0); lra.
Qed.

Example true_model_is_not_refuted_nonvacuous :
  with_probability (session [tt] 1 (fun _ => one_dimension) one_dimension single_asker) (1 - / 20) 10
    (always (fun h => ~ forall v, ball 1 1 v ->
       likelihood 1 (fun _ => one_dimension) v h <= / 20 * mixture [tt] (fun _ => 1) (fun _ => bold) h)).
Proof.
  apply true_model_is_not_refuted; try (simpl; lra).
  - unfold ball, norm, dot, one_dimension; simpl. replace (1 * 1 + 0) with 1 by ring. rewrite sqrt_1. lra.
  - intros; lra.
  - intros; apply bold_honest.
Qed.
