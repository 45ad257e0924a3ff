//! Every set of named values maps names to values and back.

use taotie::inspection::{Check, CheckStatus};
use taotie_engine::compare::ColorMap;
use taotie_engine::film::ToneCurve;
use taotie_engine::length::Unit;
use taotie_engine::math::SimdLevel;
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;
use taotie_engine::surface::{SurfaceMethod, TangentMethod};

fn names_lead_back<T: Named + std::fmt::Debug>() {
    for (name, value) in T::NAMES {
        assert_eq!(value.name(), *name);
        assert_eq!(T::from_name(name).unwrap(), *value);
    }
    let error = T::from_name("nonesuch").unwrap_err().to_string();
    assert!(T::NAMES.iter().all(|(name, _)| error.contains(name)), "{error}");
    assert!(error.contains("`nonesuch`") && error.contains(T::WHAT), "{error}");
}

#[test]
fn every_name_leads_back_and_an_unknown_one_is_told_the_list() {
    names_lead_back::<Shading>();
    names_lead_back::<SurfaceMethod>();
    names_lead_back::<TangentMethod>();
    names_lead_back::<ToneCurve>();
    names_lead_back::<SimdLevel>();
    names_lead_back::<ColorMap>();
    names_lead_back::<Check>();
    names_lead_back::<CheckStatus>();
    names_lead_back::<Unit>();
}
