//! What a certificate's matrices prove.

use std::borrow::Cow;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::compare::alike;
use super::error::CertifyError;
use super::evidence::{Evidence, Rounded};
use super::function::{ROUNDING, semidefinite};
use super::rules::Rules;
use crate::plan::document::{BallPrice, CertificateDocument, CertificateTerm, Price};

/// The matrices of a certificate, and what is known of them before any view is scored.
pub(super) struct Matrices {
    /// Y, term after term.
    pub(super) Y: Vec<DMatrix<f64>>,
    /// `Σ ⟨Y_t, M_t0⟩`.
    pub(super) given: f64,
    /// log Φ°(Y): the least and the greatest that rounding leaves open.
    pub(super) log_polar: [f64; 2],
}

impl Evidence<'_> {
    /// The matrices that a certificate states, if they are of the criteria.
    pub(super) fn matrices(&self, stated: &[CertificateTerm], mixture: &[f64]) -> Result<Matrices, CertifyError> {
        let mut rest = mixture;
        let mut mixtures = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            let (own, others) = rest.split_at(term.function.mixed().min(rest.len()));
            let in_all = if term.function.mixed() == 0 { 0.0 } else { 1.0 };
            let is_mixture = own.len() == term.function.mixed()
                && own.iter().all(|&λ| λ >= 0.0)
                && (own.iter().sum::<f64>() - in_all).abs() < 1e-9;
            if !is_mixture {
                return Err(CertifyError::Prices);
            }
            mixtures.push(own);
            rest = others;
        }
        if stated.len() != self.terms.len() || !rest.is_empty() {
            return Err(CertifyError::Prices);
        }
        let mut found = Matrices { Y: Vec::with_capacity(stated.len()), given: 0.0, log_polar: [0.0; 2] };
        // Of each scenario, or of all where their mean counts.
        let mut polars: Vec<[f64; 2]> = Vec::new();
        let mut before = None;
        let several = self.set_ups.len() > 1;
        for ((CertificateTerm { scenario, criterion, share, matrix }, term), mixture) in
            stated.iter().zip(&self.terms).zip(mixtures)
        {
            alike("the scenario of a term of the certificate", scenario, &several.then_some(term.scenario))?;
            if criterion != term.name {
                return Err(CertifyError::Criterion { stated: term.name.into(), found: criterion.clone() });
            }
            if *share != term.share {
                return Err(CertifyError::Number { what: "a share".into(), stated: *share, found: term.share });
            }
            let order = term.known.nrows();
            let Y = semidefinite(matrix, order)
                .ok_or_else(|| CertifyError::Matrix { criterion: criterion.clone(), order })?;
            found.given += term.known.dot(&Y);
            let shift = ROUNDING * order as f64;
            let [least, greatest] = [-shift, shift]
                .map(|shift| term.share * (term.function.log_polar(&Y, mixture, shift) - term.share.ln()));
            if self.is_worst() && before != Some(term.scenario) || before.is_none() {
                polars.push([0.0; 2]);
            }
            before = Some(term.scenario);
            if let Some(polar) = polars.last_mut() {
                *polar = [polar[0] + least, polar[1] + greatest];
            }
            found.Y.push(Y);
        }
        found.log_polar = [0, 1].map(|end| {
            let greatest = polars.iter().map(|polar| polar[end]).fold(f64::NEG_INFINITY, f64::max);
            greatest + polars.iter().map(|polar| (polar[end] - greatest).exp()).sum::<f64>().ln()
        });
        Ok(found)
    }

    /// The logarithm of `S / Φ°(Y)`: no allowed set of `count` views has a greater log Φ.
    pub(super) fn log_bound(&self, certificate: &CertificateDocument, count: usize) -> Result<Rounded, CertifyError> {
        // The bound is what is computed here; whether it is the one stated the caller asks.
        let CertificateDocument { bound: _, terms: stated, mixture, prices, balls } = certificate;
        let Rules { required, forbidden, groups, .. } = &self.rules;
        let ball_of = |ball: &BallPrice| (ball.separation, ball.between);
        let are_in_order = prices.windows(2).all(|pair| pair[0].group < pair[1].group)
            && balls.windows(2).all(|pair| ball_of(&pair[0]) < ball_of(&pair[1]))
            && balls.iter().all(|ball| ball.between[0] <= ball.between[1]);
        if count < required.len() || !are_in_order {
            return Err(CertifyError::Prices);
        }
        let of_group = |&Price { group, price }: &Price| Some((Cow::Borrowed(groups.get(group)?), price));
        let place = |id: usize| {
            let mut views = self.set_ups[0].views.iter();
            views.position(|view| view.as_ref().is_some_and(|view| view.id == id))
        };
        let of_ball = |&BallPrice { separation, between: [a, b], price }: &BallPrice| {
            Some((Cow::Owned(self.rules.ball(separation, place(a)?, place(b)?)?), price))
        };
        let priced: Option<Vec<_>> = prices.iter().map(of_group).chain(balls.iter().map(of_ball)).collect();
        let priced =
            priced.filter(|priced| priced.iter().all(|&(_, price)| price >= 0.0)).ok_or(CertifyError::Prices)?;
        let Matrices { Y, mut given, log_polar: [least_polar, greatest_polar] } = self.matrices(stated, mixture)?;
        let mut scores = vec![0.0; self.set_ups[0].views.len()];
        // Sums of the products' sizes, for rounding.
        let mut sizes = scores.clone();
        let mut entries = 0;
        for (Y, term) in Y.iter().zip(&self.terms) {
            let size = Y.abs();
            scores.par_iter_mut().zip(&mut sizes).enumerate().try_for_each(
                |(i, (score, total))| -> Result<(), CertifyError> {
                    let M = self.matrix(term, i)?;
                    *score += M.dot(Y);
                    *total += M.abs().dot(&size);
                    Ok(())
                },
            )?;
            entries += Y.len();
        }
        for (group, price) in priced {
            for &i in &group.members {
                scores[i] -= price;
            }
            given += price * group.most as f64;
        }
        let mut free: Vec<usize> =
            (0..scores.len()).filter(|i| !forbidden[*i] && required.binary_search(i).is_err()).collect();
        free.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]));
        free.truncate(count - required.len());
        let counted = || required.iter().chain(&free);
        // The bound holds with the least polar function.
        let S = given + counted().map(|&i| scores[i]).sum::<f64>();
        let rounding = entries as f64 * f64::EPSILON * counted().map(|&i| sizes[i]).sum::<f64>();
        let log = (S + rounding).ln() - least_polar;
        Ok(Rounded { log, uncertainty: 2.0 * rounding / S + greatest_polar - least_polar })
    }
}
