//! What the printed functions compute, in 32 bits.

use super::expression::{Expression, Function};
use super::source::functions;

/// A number or a vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// A number.
    Float(f32),
    /// Three numbers.
    Vec3([f32; 3]),
}

/// The value of one of the printed functions; none if there is no such function or it takes other arguments.
#[must_use]
pub fn evaluate(function: &str, arguments: &[Value]) -> Option<Value> {
    let all = functions();
    Machine { functions: &all }.run(function, arguments)
}

struct Machine<'a> {
    functions: &'a [Function],
}

type Names = Vec<(&'static str, Value)>;

impl Machine<'_> {
    fn run(&self, name: &str, arguments: &[Value]) -> Option<Value> {
        let function = self.functions.iter().find(|function| function.name == name)?;
        if function.parameters.len() != arguments.len() {
            return None;
        }
        let mut names: Names =
            function.parameters.iter().zip(arguments).map(|((name, _), value)| (*name, *value)).collect();
        for (name, _, value) in &function.lets {
            let value = self.value(value, &names)?;
            names.push((name, value));
        }
        self.value(&function.result, &names)
    }

    fn value(&self, expression: &Expression, names: &Names) -> Option<Value> {
        match expression {
            Expression::Number(number) => Some(Value::Float(*number)),
            Expression::Name(name) => names.iter().find(|pair| pair.0 == *name).map(|pair| pair.1),
            Expression::Vector(parts) => {
                let part = |axis: usize| self.value(&parts[axis], names)?.float();
                Some(Value::Vec3([part(0)?, part(1)?, part(2)?]))
            }
            Expression::Part(of, axis) => match self.value(of, names)? {
                Value::Vec3(parts) => Some(Value::Float(parts[*axis])),
                Value::Float(_) => None,
            },
            Expression::Binary(sign, left, right) => {
                let (left, right) = (self.value(left, names)?.float()?, self.value(right, names)?.float()?);
                Some(Value::Float(match sign {
                    '+' => left + right,
                    '-' => left - right,
                    '*' => left * right,
                    _ => left / right,
                }))
            }
            Expression::Call(name, arguments) => {
                let values = arguments.iter().map(|argument| self.value(argument, names));
                let values: Vec<Value> = values.collect::<Option<_>>()?;
                built_in(name, &values).or_else(|| self.run(name, &values))
            }
        }
    }
}

impl Value {
    fn float(self) -> Option<f32> {
        match self {
            Self::Float(number) => Some(number),
            Self::Vec3(_) => None,
        }
    }
}

/// Functions of the languages themselves.
fn built_in(name: &str, values: &[Value]) -> Option<Value> {
    use Value::{Float, Vec3};
    Some(match (name, values) {
        ("abs", [Float(x)]) => Float(x.abs()),
        ("cos", [Float(x)]) => Float(x.cos()),
        ("min", [Float(x), Float(y)]) => Float(x.min(*y)),
        ("max", [Float(x), Float(y)]) => Float(x.max(*y)),
        ("step", [Float(edge), Float(x)]) => Float(f32::from(u8::from(x >= edge))),
        ("clamp", [Float(x), Float(low), Float(high)]) => Float(x.max(*low).min(*high)),
        ("dot", [Vec3(a), Vec3(b)]) => Float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]),
        ("normalize", [Vec3(a)]) => {
            let length = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt();
            Vec3(a.map(|part| part / length))
        }
        _ => return None,
    })
}
