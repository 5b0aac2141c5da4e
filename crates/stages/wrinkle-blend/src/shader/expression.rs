//! Expressions that all three languages know.

use std::ops::{Add, Div, Mul, Sub};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Float,
    Vec3,
}

#[derive(Debug, Clone)]
pub(super) enum Expression {
    Number(f32),
    Name(&'static str),
    Binary(char, Box<Expression>, Box<Expression>),
    /// A function of the language, or one of ours before it.
    Call(&'static str, Vec<Expression>),
    Vector([Box<Expression>; 3]),
    Part(Box<Expression>, usize),
}

/// A function: some named intermediate values, then the result.
#[derive(Debug, Clone)]
pub(super) struct Function {
    pub(super) name: &'static str,
    /// What it computes, a line of comment each.
    pub(super) doc: &'static [&'static str],
    pub(super) parameters: &'static [(&'static str, Type)],
    pub(super) returns: Type,
    pub(super) lets: Vec<(&'static str, Type, Expression)>,
    pub(super) result: Expression,
}

pub(super) fn name(name: &'static str) -> Expression {
    Expression::Name(name)
}

pub(super) fn call(function: &'static str, arguments: impl IntoIterator<Item = Expression>) -> Expression {
    Expression::Call(function, arguments.into_iter().collect())
}

pub(super) fn vector(parts: [Expression; 3]) -> Expression {
    Expression::Vector(parts.map(Box::new))
}

impl Expression {
    pub(super) fn x(self) -> Self {
        Self::Part(Box::new(self), 0)
    }

    pub(super) fn y(self) -> Self {
        Self::Part(Box::new(self), 1)
    }

    pub(super) fn z(self) -> Self {
        Self::Part(Box::new(self), 2)
    }
}

impl From<f32> for Expression {
    fn from(number: f32) -> Self {
        Self::Number(number)
    }
}

macro_rules! operator {
    ($($operator:ident $method:ident $sign:literal),*) => {
        $(impl<T: Into<Expression>> $operator<T> for Expression {
            type Output = Expression;
            fn $method(self, other: T) -> Expression {
                Expression::Binary($sign, Box::new(self), Box::new(other.into()))
            }
        }
        impl $operator<Expression> for f32 {
            type Output = Expression;
            fn $method(self, other: Expression) -> Expression {
                Expression::Binary($sign, Box::new(self.into()), Box::new(other))
            }
        })*
    };
}
operator!(Add add '+', Sub sub '-', Mul mul '*', Div div '/');
