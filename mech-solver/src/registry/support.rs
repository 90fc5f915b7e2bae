//! Support of effects by models. A model supports an effect if it uses all kinds of terms that the
//! effect creates.

use crate::effects::EFFECTS;
use crate::models::MODELS;
use crate::registry::entry::{Effect, ModelEntry};
use crate::terms::Terms;
use proto::configuration::{Configuration, Refusal};

/// Returns true if a model supports an effect.
fn supports(model: &ModelEntry, effect: &Effect) -> bool {
    effect.kinds.iter().all(|kind| model.takes.contains(kind))
}

/// Names of the models that support an effect.
pub(crate) fn models_of(effect: &Effect) -> Vec<String> {
    let supporting = MODELS.iter().filter(|model| supports(model, effect));
    supporting.map(|model| model.name.to_owned()).collect()
}

/// Returns the effects of a configuration in the order of [`EFFECTS`]. The order of the tables in
/// the case has no influence.
///
/// # Errors
/// An effect that is not in [`EFFECTS`], or that the chosen model does not support.
pub(crate) fn active(configuration: &Configuration) -> Result<Vec<&'static Effect>, Refusal> {
    let table = configuration.case.get("effects").and_then(serde_json::Value::as_object);
    let named = table.into_iter().flatten();
    let supported = named.map(|(name, _)| supported(name, &configuration.model));
    let mut active = supported.collect::<Result<Vec<_>, _>>()?;
    active.sort_by_key(|effect| EFFECTS.iter().position(|own| own.name == effect.name));
    Ok(active)
}

/// Refuses values of keys that need a kind the model does not use.
///
/// # Errors
/// A value that the model does not support.
pub(crate) fn refuse_needs(model: &ModelEntry, terms: &Terms) -> Result<(), Refusal> {
    let Some(need) = terms.needs.iter().find(|need| !model.takes.contains(&need.kind)) else {
        return Ok(());
    };
    let others = MODELS.iter().filter(|model| model.takes.contains(&need.kind));
    let others: Vec<_> = others.map(|model| format!("\"{}\"", model.name)).collect();
    Err(Refusal::new(
        need.key,
        format!("the model `{}` has no {}", model.name, need.lacks),
        format!("choose mech.model = {}, or write \"{}\"", others.join(" or "), need.instead),
    ))
}

fn supported(name: &str, model: &str) -> Result<&'static Effect, Refusal> {
    let key = format!("effects.{name}");
    let Some(effect) = EFFECTS.iter().find(|effect| effect.name == name) else {
        let known: Vec<_> = EFFECTS.iter().map(|effect| effect.name).collect();
        let reason = "there is no such effect in the mechanics";
        return Err(Refusal::new(&key, reason, format!("known are {}", known.join(", "))));
    };
    let models = models_of(effect);
    if models.iter().any(|supporting| supporting == model) {
        return Ok(effect);
    }
    let fix = format!("choose one of {} or remove the effect", models.join(", "));
    Err(Refusal::new(&key, format!("the model `{model}` does not support it"), fix))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::Kind;
    use proto::configuration::Mode;
    use proto::description::KeyKind;
    use proto::params::Params;
    use serde_json::json;

    /// Every effect creates terms of the declared kinds and of no others. The case contains the
    /// smallest set of quantities that the effect needs, and a share of the heat.
    #[test]
    fn effects_make_the_kinds_that_they_declare() {
        for effect in EFFECTS {
            let mut table = json!({});
            for key in (effect.keys)().iter().filter(|key| key.required || key.one_of.is_some()) {
                if let KeyKind::Quantity { .. } = key.kind {
                    table[key.path.rsplit('.').next().unwrap()] = json!(1e-6);
                }
            }
            if effect.kinds.contains(&Kind::HeatShare) {
                table["heat_share"] = json!(0.5);
            }
            if effect.name == "stress_at_points" {
                table["axis"] = json!({"body": "other", "z": [-1e-3, 0.0]});
            }
            if effect.name == "friction_bands" {
                let bands = "/../cases/profiles/greased-gauge-side.csv";
                table["table"] = json!(format!("{}{bands}", env!("CARGO_MANIFEST_DIR")));
            }
            let softer =
                concat!(env!("CARGO_MANIFEST_DIR"), "/../cases/materials/steel-softening.csv");
            let body = |position: &str| json!({"position": position, "material": "steel"});
            let case = json!({
                "bodies": {"one": body("upper"), "other": body("lower")},
                "materials": {"steel": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "yield_stress": 1e9,
                    "thermal_expansion": 1e-5,
                    "delayed_compliance_ratio": 1.0, "retardation_time": 1e-3, "softening_table": softer, "wear_per_joule": 1e-12}},
                "motion": {"speed": 1.0, "creepage": {"xi": 0.0}},
                "load": {"normal_force": 1.0},
                "friction": {"coefficient": 0.5},
                "effects": {effect.name: table},
            });
            let configuration = Configuration {
                role: "mech".to_owned(),
                model: "any".to_owned(),
                mode: Mode::Steady,
                windows: None,
                case: Params(case),
                histories: None,
                inputs: Vec::new(),
                outputs: Vec::new(),
                observed: Vec::new(),
                threads: 1,
            };
            let terms = crate::effects::terms(&[effect], &configuration).unwrap();
            assert_eq!(terms.kinds(), effect.kinds, "{}", effect.name);
        }
    }

    /// The page on adding an effect lists every kind that a model uses.
    #[test]
    fn the_page_lists_the_kinds() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/add-an-effect.md");
        let page = std::fs::read_to_string(page).unwrap();
        for kind in MODELS.iter().flat_map(|model| model.takes) {
            assert!(page.contains(&format!("\n| `{kind:?}` |")), "{kind:?}");
        }
    }

    /// Effects are in the order of the list, whatever the order of their tables.
    #[test]
    fn the_order_of_tables_is_that_of_the_list() {
        let mut effects = serde_json::Map::new();
        for name in ["viscous_layer", "shear_limit", "friction_bands"] {
            effects.insert(name.to_owned(), json!({}));
        }
        let configuration = Configuration {
            role: "mech".to_owned(),
            model: "half-space".to_owned(),
            mode: Mode::Steady,
            windows: None,
            case: Params(json!({ "effects": effects })),
            histories: None,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: Vec::new(),
            threads: 1,
        };
        let names: Vec<_> =
            active(&configuration).unwrap().iter().map(|effect| effect.name).collect();
        assert_eq!(names, ["friction_bands", "shear_limit", "viscous_layer"]);
    }
}
