(* The count estimate of a kernel maximises the likelihood of the recorded transitions. *)
Require Import Reals List Lra Lia Bool.
Require Import Bridge.Sums Bridge.Process Bridge.Mdp Bridge.Small.
Import ListNotations.
Open Scope R_scope.

Section Counts.
Context {X : finite}.

Definition count (l : list X) (x : X) : nat := length (filter (fun y => eqb y x) l).

Lemma count_pos l x : In x l -> 0 < INR (count l x).
Proof.
  intros I. apply lt_0_INR. unfold count. assert (In x (filter (fun y => eqb y x) l)) as J.
  { apply filter_In. split; auto. apply eqb_refl. }
  destruct (filter _ l); [destruct J|simpl; lia].
Qed.

(* A sum over a list, sorted by the elements. *)
Lemma sum_by_element (f : X -> R) l : sum f l = sum (fun x => INR (count l x) * f x) (elements X).
Proof.
  induction l as [|y l IH].
  - simpl. symmetry. transitivity (sum (fun _ : X => 0) (elements X)); [|apply sum_zero].
    apply sum_ext. intros; simpl; ring.
  - cbn [sum]. rewrite IH, <- (sum_at y f) at 1. rewrite <- sum_plus. apply sum_ext. intros x _.
    unfold count; cbn [filter]. destruct (eqb y x) eqn:E.
    + apply eqb_true in E. subst. rewrite eqb_refl. cbn [length]. rewrite S_INR. simpl. ring.
    + assert (eqb x y = false) as ->; [|simpl; ring].
      apply eqb_false. intros K. subst. rewrite eqb_refl in E. discriminate.
Qed.

End Counts.

Section Estimate.
Context {St Ac : finite}.

Notation transition := (pairs (pairs St Ac) St).

(* The transitions within a trajectory; the last pair of a trajectory leads nowhere. *)
Fixpoint transitions (t : trajectory St Ac) : list transition :=
  match t with
  | (s', _) :: ((m :: _) as past) => (m, s') :: transitions past
  | _ => []
  end.

Definition row_of (P : St -> Ac -> law St) (z : transition) : R := P (fst (fst z)) (snd (fst z)) (snd z).

(* The likelihood of the transitions of a data set. *)
Definition transition_likelihood (P : St -> Ac -> law St) (D : list (trajectory St Ac)) : R :=
  product (row_of P) (flat_map transitions D).

Definition first_factor (start : law St) (t : trajectory St Ac) : R :=
  match rev t with [] => 1 | (s, _) :: _ => start s end.

Lemma dynamics_by_transitions start P t :
  dynamics_factor (markov start P) t = first_factor start t * product (row_of P) (transitions t).
Proof.
  induction t as [|[s a] t IH]; [simpl; unfold first_factor; simpl; ring|].
  cbn [dynamics_factor]. rewrite IH. destruct t as [|[s0 a0] t].
  - unfold first_factor; simpl. ring.
  - assert (first_factor start ((s, a) :: (s0, a0) :: t) = first_factor start ((s0, a0) :: t)) as ->.
    { unfold first_factor. cbn [rev]. destruct (rev t); reflexivity. }
    cbn [transitions product markov]. unfold row_of at 2. cbn [fst snd]. ring.
Qed.

Lemma law_likelihood start P pi D :
  product (trajectory_law (markov start P) pi) D
  = product (fun t => first_factor start t * policy_factor pi t) D * transition_likelihood P D.
Proof.
  unfold transition_likelihood. induction D as [|t D IH]; [simpl; ring|].
  cbn [product flat_map]. rewrite IH, product_app, factorisation, dynamics_by_transitions. ring.
Qed.

(* An estimate at least as likely as every kernel; ties and rows without data are left open. *)
Definition likeliest_kernel (D : list (trajectory St Ac)) (Phat : St -> Ac -> law St) : Prop :=
  forall P, transition_likelihood P D <= transition_likelihood Phat D.

Lemma likeliest_law start Phat pi D : likeliest_kernel D Phat -> forall P,
  product (trajectory_law (markov start P) pi) D <= product (trajectory_law (markov start Phat) pi) D.
Proof.
  intros L P. rewrite !law_likelihood. apply Rmult_le_compat_l; [|apply L]. apply product_nonneg. intros t _.
  apply Rmult_le_pos; [|apply policy_factor_nonneg].
  unfold first_factor. destruct (rev t) as [|[s a] u]; [lra|apply mass_nonneg].
Qed.

(* Counts of the transitions, and a default row where none was recorded. *)
Variable default : St -> Ac -> law St.

Definition pair_count (D : list (trajectory St Ac)) (m : pairs St Ac) : R :=
  sum (fun s' => INR (count (flat_map transitions D) ((m, s') : transition))) (elements St).

Definition count_mass (D : list (trajectory St Ac)) (s : St) (a : Ac) (s' : St) : R :=
  if Rle_dec (pair_count D (s, a)) 0 then default s a s'
  else INR (count (flat_map transitions D) (((s, a), s') : transition)) / pair_count D (s, a).

Definition count_estimate (D : list (trajectory St Ac)) (s : St) (a : Ac) : law St.
Proof.
  refine (Law St (count_mass D s a) _ _).
  - intros s'. unfold count_mass. destruct (Rle_dec _ 0) as [L|L]; [apply mass_nonneg|].
    unfold Rdiv. apply Rmult_le_pos; [apply pos_INR|]. left. apply Rinv_0_lt_compat. lra.
  - unfold count_mass. destruct (Rle_dec _ 0) as [L|L]; [apply mass_total|].
    unfold Rdiv. rewrite sum_scal_r. fold (pair_count D (s, a)). apply Rinv_r. lra.
Defined.

Lemma product_below_one {A : Type} (f : A -> R) (l : list A) : (forall x, In x l -> 0 <= f x) ->
  sum f l <= INR (length l) -> product f l <= 1.
Proof.
  intros Pf S. apply Rle_trans with (exp (sum (fun x => f x - 1) l)).
  - clear S. induction l as [|x l IH]; [simpl; rewrite exp_0; lra|]. cbn [product sum]. rewrite exp_plus.
    apply Rmult_le_compat; auto with *.
    + apply product_nonneg; auto with *.
    + pose proof (one_plus_le_exp (f x - 1)). lra.
  - replace (sum (fun x => f x - 1) l) with (sum f l - INR (length l))
      by (rewrite <- (Rmult_1_r (INR (length l))), <- sum_const, <- sum_minus; reflexivity).
    rewrite <- exp_0. destruct (Req_dec (sum f l - INR (length l)) 0) as [Z|Z]; [rewrite Z; lra|].
    left. apply exp_increasing. lra.
Qed.

Lemma recorded_mass D z : In z (flat_map transitions D) ->
  0 < INR (count (flat_map transitions D) z) <= pair_count D (fst z)
  /\ row_of (count_estimate D) z = INR (count (flat_map transitions D) z) / pair_count D (fst z).
Proof.
  intros I. pose proof (count_pos _ z I) as Pc. destruct z as [[s a] s']. cbn [fst] in *.
  assert (INR (count (flat_map transitions D) (((s, a), s') : transition)) <= pair_count D (s, a)) as L.
  { apply (term_le_sum (fun s1 => INR (count (flat_map transitions D) (((s, a), s1) : transition)))).
    - intros; apply pos_INR.
    - apply complete. }
  assert (0 < pair_count D (s, a)) as P0 by exact (Rlt_le_trans _ _ _ Pc L).
  split; [split; auto|]. unfold row_of; cbn [fst snd count_estimate mass]. unfold count_mass.
  destruct (Rle_dec _ 0) as [K|K]; [|reflexivity]. exfalso. lra.
Qed.

(* label: audit T6(ii), discharge for the package's estimate *)
Theorem count_estimate_is_likeliest D : likeliest_kernel D (count_estimate D).
Proof.
  intros P. set (l := flat_map transitions D). unfold transition_likelihood. fold l.
  set (ratio := fun z => row_of P z / row_of (count_estimate D) z).
  assert (Q : forall z, In z l -> 0 < row_of (count_estimate D) z).
  { intros z I. destruct (recorded_mass D z I) as [[A B] ->]. unfold Rdiv.
    apply Rmult_lt_0_compat; [exact A|]. apply Rinv_0_lt_compat. lra. }
  assert (E : product (row_of P) l = product ratio l * product (row_of (count_estimate D)) l).
  { rewrite <- product_mult. apply product_ext. intros z I. unfold ratio. specialize (Q z I). field. lra. }
  rewrite E. rewrite <- (Rmult_1_l (product (row_of (count_estimate D)) l)) at 2.
  apply Rmult_le_compat_r; [apply product_nonneg; intros; left; auto|].
  apply product_below_one.
  - intros z I. unfold ratio, Rdiv. apply Rmult_le_pos; [apply mass_nonneg|]. left. apply Rinv_0_lt_compat; auto.
  - rewrite (sum_by_element ratio l).
    replace (INR (length l)) with (sum (fun z => INR (count l z) * 1) (elements transition)).
    2: { rewrite <- (sum_by_element (fun _ => 1) l), sum_const. ring. }
    rewrite !(sum_pairs (X := pairs St Ac) (Y := St)). apply sum_le. intros m _.
    apply Rle_trans with (sum (fun s' => pair_count D m * P (fst m) (snd m) s') (elements St)).
    + apply sum_le. intros s' _. destruct (count l ((m, s') : transition)) as [|k] eqn:Ek.
      * simpl. rewrite Rmult_0_l. apply Rmult_le_pos; [|apply mass_nonneg]. apply sum_nonneg. intros; apply pos_INR.
      * assert (In ((m, s') : transition) l) as I.
        { unfold count in Ek. destruct (filter (fun y => eqb y ((m, s') : transition)) l) as [|y r] eqn:F;
            [discriminate|].
          assert (In y (y :: r)) as J by (left; auto). rewrite <- F in J. apply filter_In in J.
          destruct J as [J K]. apply eqb_true in K. subst; auto. }
        destruct (recorded_mass D _ I) as [[A B] R1]. unfold ratio. rewrite R1. fold l in A, B |- *.
        rewrite Ek in *. cbn [fst] in *. right. unfold row_of; cbn [fst snd]. field. split; lra.
    + rewrite sum_scal, mass_total. right. unfold pair_count. fold l. rewrite sum_scal_r. ring.
Qed.

End Estimate.

Example count_estimate_is_likeliest_nonvacuous :
  let D := [[(true, true); (true, false)]; [(false, false); (true, false)]] : list (trajectory two two) in
  likeliest_kernel D (count_estimate (fun s _ => dirac s) D).
Proof. intros D. apply count_estimate_is_likeliest. Qed.
