//! `#[derive(Params)]`.

use crate::{Tokens, named_fields, required_docs};
use quote::quote;
use syn::ext::IdentExt;
use syn::{DeriveInput, Expr, ExprLit, ExprRange, Field, Lit, LitStr, RangeLimits};

/// What `#[param(…)]` says.
#[derive(Default)]
struct Attributes {
    default: Option<Expr>,
    unit: Option<LitStr>,
    range: Option<ExprRange>,
    odd: bool,
    catalog: Option<LitStr>,
    entry_of: Option<LitStr>,
    shared: bool,
}

impl Attributes {
    /// Whether nothing is said of a single parameter.
    fn is_plain(&self) -> bool {
        let Self { default, unit, range, odd, catalog, .. } = self;
        default.is_none() && unit.is_none() && range.is_none() && !odd && catalog.is_none()
    }
}

/// A field of the struct and what its attributes say.
struct Param<'a> {
    field: &'a Field,
    key: String,
    attributes: Attributes,
}

pub(crate) fn expand(input: &DeriveInput) -> syn::Result<Tokens> {
    let name = &input.ident;
    let about = required_docs(&input.attrs, name)?;
    let fields = named_fields(input)?;
    let params = fields.into_iter().map(read).collect::<syn::Result<Vec<_>>>()?;
    for param in &params {
        check_entry_of(param, &params)?;
        check_shared(param)?;
    }
    let own = params.iter().filter(|param| param.attributes.entry_of.is_none());
    let specs = own.map(|param| match param.attributes.shared {
        true => Ok(shared_specs(param)),
        false => spec(param, &params).map(|spec| quote!(specs.push(#spec);)),
    });
    let specs = specs.collect::<syn::Result<Vec<_>>>()?;
    let reads = params.iter().map(|param| {
        let (ident, key) = (&param.field.ident, &param.key);
        match &param.attributes.entry_of {
            Some(chooser) => quote!(#ident: values.of_entry(#chooser)),
            None if param.attributes.shared => {
                quote!(#ident: ::carvegraph_core::Params::from_values(values))
            }
            None => quote!(#ident: ::carvegraph_core::ParamField::from_values(values, #key)),
        }
    });
    Ok(quote! {
        impl ::carvegraph_core::Params for #name {
            fn about() -> &'static str { #about }
            fn specs() -> ::std::vec::Vec<::carvegraph_core::ParamSpec> {
                #[allow(unused_mut, reason = "a node may have no parameters")]
                let mut specs = ::std::vec::Vec::new();
                #(#specs)*
                specs
            }
            fn from_values(values: &::carvegraph_core::ParamValues) -> Self {
                let _ = values;
                Self { #(#reads),* }
            }
        }
    })
}

fn read(field: &Field) -> syn::Result<Param<'_>> {
    let key = field.ident.as_ref().map(|name| name.unraw().to_string()).unwrap_or_default();
    Ok(Param { field, key, attributes: read_attributes(field)? })
}

/// A field that takes the parameters of an entry has a field that chooses the entry, and says
/// nothing else, since all else is said by the entry.
fn check_entry_of(param: &Param<'_>, params: &[Param<'_>]) -> syn::Result<()> {
    let Some(chooser) = &param.attributes.entry_of else { return Ok(()) };
    let is_chooser =
        |param: &Param<'_>| param.key == chooser.value() && param.attributes.catalog.is_some();
    match () {
        () if !param.attributes.is_plain() || param.attributes.shared => {
            Err(syn::Error::new_spanned(param.field, "entry_of stands alone"))
        }
        () if !params.iter().any(is_chooser) => {
            Err(syn::Error::new_spanned(chooser, "entry_of names a field with a catalog"))
        }
        () => required_docs(&param.field.attrs, param.field).map(drop),
    }
}

/// A field of shared parameters says nothing else: the struct that declares them does.
fn check_shared(param: &Param<'_>) -> syn::Result<()> {
    match param.attributes.shared && !param.attributes.is_plain() {
        true => Err(syn::Error::new_spanned(param.field, "shared stands alone")),
        false => Ok(()),
    }
}

fn shared_specs(param: &Param<'_>) -> Tokens {
    let ty = &param.field.ty;
    quote!(specs.extend(<#ty as ::carvegraph_core::Params>::specs());)
}

fn spec(param: &Param<'_>, params: &[Param<'_>]) -> syn::Result<Tokens> {
    let Param { field, key, attributes } = param;
    let about = required_docs(&field.attrs, field)?;
    let ty = &field.ty;
    let default = match &attributes.default {
        None => quote!(::std::option::Option::None),
        Some(value) => {
            let value = typed_default(value);
            quote!({
                let default: <#ty as ::carvegraph_core::ParamField>::Plain = #value;
                ::std::option::Option::Some(::carvegraph_core::ParamField::to_value(&default))
            })
        }
    };
    let unit = optional(attributes.unit.as_ref().map(|unit| quote!(#unit)));
    let catalog = optional(attributes.catalog.as_ref().map(|catalog| quote!(#catalog)));
    let (min, max) = limits(attributes.range.as_ref())?;
    let odd = attributes.odd;
    let takes_params = params.iter().any(|other| {
        other.attributes.entry_of.as_ref().is_some_and(|chooser| chooser.value() == *key)
    });
    Ok(quote! {
        ::carvegraph_core::ParamSpec {
            name: #key,
            about: ::std::borrow::Cow::Borrowed(#about),
            kind: <#ty as ::carvegraph_core::ParamField>::kind(&::carvegraph_core::ParamHints {
                unit: #unit,
                min: #min,
                max: #max,
                odd: #odd,
                catalog: #catalog,
                takes_params: #takes_params,
            }),
            default: #default,
            yields: <#ty as ::carvegraph_core::ParamField>::YIELDS,
        }
    })
}

fn read_attributes(field: &Field) -> syn::Result<Attributes> {
    let mut attributes = Attributes::default();
    for attribute in field.attrs.iter().filter(|a| a.path().is_ident("param")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("default") {
                attributes.default = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("unit") {
                attributes.unit = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("range") {
                attributes.range = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("catalog") {
                attributes.catalog = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("entry_of") {
                attributes.entry_of = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("odd") {
                attributes.odd = true;
            } else if meta.path.is_ident("shared") {
                attributes.shared = true;
            } else {
                let known = "unknown: default, unit, range, odd, catalog, entry_of or shared";
                return Err(meta.error(known));
            }
            Ok(())
        })?;
    }
    Ok(attributes)
}

/// A text literal becomes whatever the field's type makes of it; anything else is taken as it is.
fn typed_default(value: &Expr) -> Tokens {
    match value {
        Expr::Lit(ExprLit { lit: Lit::Str(_), .. }) => quote!(::std::convert::From::from(#value)),
        _ => quote!(#value),
    }
}

fn optional(value: Option<Tokens>) -> Tokens {
    match value {
        Some(value) => quote!(::std::option::Option::Some(#value)),
        None => quote!(::std::option::Option::None),
    }
}

/// Both ends of the range as `f64`; an open end is infinite.
fn limits(range: Option<&ExprRange>) -> syn::Result<(Tokens, Tokens)> {
    let Some(range) = range else {
        return Ok((quote!(f64::NEG_INFINITY), quote!(f64::INFINITY)));
    };
    if range.end.is_some() && matches!(range.limits, RangeLimits::HalfOpen(_)) {
        return Err(syn::Error::new_spanned(range, "write ..=, the last value is allowed"));
    }
    let end = |value: &Option<Box<Expr>>, open: Tokens| match value {
        Some(value) => quote!((#value) as f64),
        None => open,
    };
    Ok((end(&range.start, quote!(f64::NEG_INFINITY)), end(&range.end, quote!(f64::INFINITY))))
}
