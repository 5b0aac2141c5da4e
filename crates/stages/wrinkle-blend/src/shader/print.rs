//! Expressions as text of a language.

use super::Language;
use super::expression::{Expression, Function, Type};
use super::source::functions;

/// The functions as a snippet to include.
#[must_use]
pub fn text(language: Language) -> String {
    let head = "// Wrinkles that follow the bones [DutreveMeyer2011, Eq. 4-8]. Printed by `wrinkle-blend shader`; do not edit.\n";
    functions()
        .iter()
        .fold(head.to_string(), |text, function| text + "\n" + &self::function(language, function))
}

fn function(language: Language, function: &Function) -> String {
    let mut text: String = function.doc.iter().map(|line| format!("// {line}\n")).collect();
    let parameters: Vec<String> = function
        .parameters
        .iter()
        .map(|(name, of)| match language {
            Language::Wgsl => format!("{name}: {}", type_name(language, *of)),
            _ => format!("{} {name}", type_name(language, *of)),
        })
        .collect();
    let (name, parameters, returns) =
        (function.name, parameters.join(", "), type_name(language, function.returns));
    text += &match language {
        Language::Wgsl => format!("fn {name}({parameters}) -> {returns} {{\n"),
        _ => format!("{returns} {name}({parameters}) {{\n"),
    };
    for (name, of, value) in &function.lets {
        let value = expression(language, value, 0);
        text += &match language {
            Language::Wgsl => format!("    let {name} = {value};\n"),
            _ => format!("    {} {name} = {value};\n", type_name(language, *of)),
        };
    }
    text + &format!("    return {};\n}}\n", expression(language, &function.result, 0))
}

fn type_name(language: Language, of: Type) -> &'static str {
    match (of, language) {
        (Type::Float, Language::Wgsl) => "f32",
        (Type::Float, _) => "float",
        (Type::Vec3, Language::Glsl) => "vec3",
        (Type::Vec3, Language::Hlsl) => "float3",
        (Type::Vec3, Language::Wgsl) => "vec3<f32>",
    }
}

/// The text of an expression, in brackets where an operator of rank `above` would tear it apart.
fn expression(language: Language, value: &Expression, above: u8) -> String {
    let list = |values: &[&Expression]| {
        values.iter().map(|value| expression(language, value, 0)).collect::<Vec<_>>().join(", ")
    };
    match value {
        Expression::Number(number) => format!("{number:?}"),
        Expression::Name(name) => (*name).to_string(),
        Expression::Call(function, arguments) => {
            format!("{function}({})", list(&arguments.iter().collect::<Vec<_>>()))
        }
        Expression::Vector(parts) => {
            format!("{}({})", type_name(language, Type::Vec3), list(&[&parts[0], &parts[1], &parts[2]]))
        }
        Expression::Part(of, axis) => {
            format!("{}.{}", expression(language, of, 3), ["x", "y", "z"][*axis])
        }
        Expression::Binary(sign, left, right) => {
            let rank = if matches!(sign, '+' | '-') { 1 } else { 2 };
            // What stands right of a minus or a division keeps brackets of its own rank.
            let inner = rank + u8::from(matches!(sign, '-' | '/'));
            let text =
                format!("{} {sign} {}", expression(language, left, rank), expression(language, right, inner));
            if rank < above { format!("({text})") } else { text }
        }
    }
}
