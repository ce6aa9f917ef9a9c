//! What is written out for a declaration.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::{Error, Ident, Result};

use crate::{
    declaration::{Declaration, Wire},
    field::{Field, Kind},
    text,
};

/// The struct with its layout, as a sample whose conversions are written by hand.
pub fn sample(declaration: &Declaration) -> TokenStream {
    let layout = layout(declaration, &[]);
    let name = &declaration.name;
    quote! {
        #layout

        // SAFETY: `repr(C)`, no padding and all fields plain data, each of which is checked
        // where the layout is.
        unsafe impl crate::Sample for #name {
            const FIELDS: &'static [crate::sample::Field] = &[];
        }
    }
}

/// All of a message.
pub fn message(declaration: &Declaration) -> Result<TokenStream> {
    let name = &declaration.name;
    let (ros, ros_struct) = match &declaration.wire {
        Wire::Standard(path) => (quote!(#path), quote!()),
        Wire::Own(own) => (quote!(#own), ros_struct(declaration, own)),
        Wire::ByHand => return Err(Error::new_spanned(name, "nothing on the wire")),
    };
    let interface = match &declaration.wire {
        Wire::Own(own) => format!("`ferntast_msgs/msg/{own}` on the wire."),
        _ => format!(
            "`{}` on the wire.",
            ros.to_string().replace(" :: ", "/msg/")
        ),
    };
    let layout = layout(declaration, &[String::new(), interface]);
    let initial = initial(declaration);
    let stops = declaration.stops.iter().map(|function| {
        quote! {
            fn stops(&self) -> bool {
                #function(self)
            }
        }
    });
    let stops = quote!(#(#stops)*);
    let (to_ros, from_ros, check) = (
        to_ros(declaration),
        from_ros(declaration),
        check(declaration),
    );
    let rules = rules(declaration);
    Ok(quote! {
        #layout
        #ros_struct
        #initial

        // SAFETY: `repr(C)`, no padding and all fields plain data, each of which is checked
        // where the layout is.
        unsafe impl crate::Sample for #name {
            const FIELDS: &'static [crate::sample::Field] = &[#(#rules),*];
        }

        impl crate::Message for #name {
            type Ros = #ros;

            fn stamp(&self) -> crate::Time {
                self.stamp
            }

            fn to_ros(&self) -> #ros {
                #ros {
                    header: crate::ros::std_msgs::Header::new(self.stamp, ""),
                    #(#to_ros)*
                }
            }

            fn from_ros(ros: &#ros) -> Result<#name, crate::InvalidMessage> {
                let mut sample = #name::initial(ros.header.time());
                #from_ros
                crate::Message::check(&sample)?;
                Ok(sample)
            }

            fn check(&self) -> Result<(), crate::InvalidMessage> {
                #check
                Ok(())
            }

            #stops
        }
    })
}

/// The struct by falling alignment, without padding.
fn layout(declaration: &Declaration, more_docs: &[String]) -> TokenStream {
    let mut fields: Vec<&Field> = declaration.fields.iter().collect();
    fields.sort_by_key(|field| std::cmp::Reverse(field.layout().1));
    let count = declaration.first_list().map(|_| {
        quote! {
            /// Elements in the lists; what stands after them is zero.
            pub count: u32,
        }
    });
    let left = declaration.reserved();
    let reserved = (left > 0).then(|| {
        quote! {
            /// Keeps the layout free of implicit padding.
            pub reserved: [u8; #left],
        }
    });
    let Declaration {
        visibility,
        name,
        docs,
        ..
    } = declaration;
    // The count stands where its alignment is: after what has eight bytes.
    let (first, second): (Vec<&Field>, Vec<&Field>) =
        fields.into_iter().partition(|field| field.layout().1 == 8);
    let written = |fields: &[&Field]| -> Vec<TokenStream> {
        fields
            .iter()
            .map(|field| {
                let docs = field.documentation();
                let (visibility, name, r#type) = (&field.visibility, &field.name, &field.r#type);
                quote!(#docs #visibility #name: #r#type,)
            })
            .collect()
    };
    let (first, second) = (written(&first), written(&second));
    let types: Vec<_> = declaration.fields.iter().map(|own| &own.r#type).collect();
    let counted = declaration.first_list().map(|_| quote!(+ size_of::<u32>()));
    let padding = format!("{name} has padding: say the size of a field with #[field(bytes = N)]");
    quote! {
        #(#[doc = #docs])*
        #(#[doc = #more_docs])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        #visibility struct #name {
            #(#first)*
            #count
            #(#second)*
            #reserved
        }

        const _: () = assert!(
            size_of::<#name>() == #left #(+ size_of::<#types>())* #counted,
            #padding
        );
        const _: fn() = || {
            fn plain<T: crate::sample::Plain>() {}
            #(plain::<#types>();)*
        };
    }
}

/// The ROS 2 form of a message of ferntast's own.
fn ros_struct(declaration: &Declaration, own: &Ident) -> TokenStream {
    let interface = format!("ferntast_msgs/msg/{own}");
    let docs = format!("The ROS 2 form of [`{}`].", declaration.name);
    let text = text::msg(declaration);
    let fields = declaration.on_wire().map(|field| {
        let docs = field.documentation();
        let (name, r#type) = (&field.wire_name, field.ros_type());
        quote!(#docs pub #name: #r#type,)
    });
    quote! {
        #[doc = #docs]
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct #own {
            /// When; no frame.
            pub header: crate::ros::std_msgs::Header,
            #(#fields)*
        }

        crate::message::ros_message!(#own, #interface, Some(#text));
    }
}

/// The message before anything is known.
fn initial(declaration: &Declaration) -> TokenStream {
    let name = &declaration.name;
    let fields = declaration.fields.iter().map(|field| {
        let (name, r#type) = (&field.name, &field.r#type);
        let value = match &field.kind {
            Kind::Stamp => quote!(stamp),
            Kind::Float if field.or_nan => quote!(#r#type::NAN),
            Kind::Float if field.or_infinite => quote!(#r#type::INFINITY),
            Kind::Float => quote!(0.0),
            Kind::Integer | Kind::Flag | Kind::Identity => quote!(0),
            Kind::Text => quote!(crate::Text::EMPTY),
            Kind::Floats(room) => quote!([0.0; #room]),
            Kind::Texts(room) => quote!([crate::Text::EMPTY; #room]),
            Kind::Named => quote!(<#r#type as crate::sample::Named>::INITIAL),
        };
        quote!(#name: #value,)
    });
    let (count, length) = match declaration.first_list().and_then(|own| own.kind.list()) {
        None => (quote!(), quote!()),
        Some(room) => (
            quote!(count: 0,),
            quote! {
                /// Elements in the lists, never more than there is room for.
                pub fn len(&self) -> usize {
                    (self.count as usize).min(#room)
                }

                /// Whether the lists are empty.
                pub fn is_empty(&self) -> bool {
                    self.count == 0
                }
            },
        ),
    };
    let left = declaration.reserved();
    let reserved = (left > 0).then(|| quote!(reserved: [0; #left],));
    quote! {
        impl #name {
            /// The message before anything is known: numbers zero (NaN or infinite where that
            /// stands for it), texts empty, codes the first.
            pub const fn initial(stamp: crate::Time) -> #name {
                #name { #(#fields)* #count #reserved }
            }

            #length
        }
    }
}

fn to_ros(declaration: &Declaration) -> Vec<TokenStream> {
    let write = |field: &Field| {
        let (name, wire_name) = (&field.name, &field.wire_name);
        let value = match &field.kind {
            Kind::Flag => quote!(self.#name != 0),
            Kind::Text => quote!(self.#name.as_str().to_owned()),
            Kind::Identity => quote!(crate::sample::identity::text(self.#name)),
            Kind::Named => quote!(crate::sample::Named::wire_name(self.#name)),
            Kind::Floats(_) => quote!(self.#name.iter().take(self.len()).copied().collect()),
            Kind::Texts(_) => {
                quote!(self.#name.iter().take(self.len()).map(|own| own.as_str().to_owned()).collect())
            }
            Kind::Stamp | Kind::Float | Kind::Integer => quote!(self.#name),
        };
        quote!(#wire_name: #value,)
    };
    declaration.on_wire().map(write).collect()
}

fn from_ros(declaration: &Declaration) -> TokenStream {
    let count = declaration.first_list().map(|first| {
        let (name, room) = (&first.wire_name, first.kind.list());
        let field = name.to_string();
        quote! {
            crate::sample::lists::fits(#field, ros.#name.len(), #room)?;
            sample.count = ros.#name.len() as u32;
        }
    });
    let read = declaration.on_wire().map(|field| {
        let (name, wire_name) = (&field.name, &field.wire_name);
        let word = wire_name.to_string();
        match &field.kind {
            Kind::Floats(_) => quote! {
                crate::sample::lists::fill(#word, &mut sample.#name, sample.count, &ros.#wire_name, |own| *own)?;
            },
            Kind::Texts(_) => quote! {
                crate::sample::lists::fill(#word, &mut sample.#name, sample.count, &ros.#wire_name, |own| crate::Text::new(own))?;
            },
            Kind::Flag => quote!(sample.#name = ros.#wire_name.into();),
            Kind::Text if field.whole.is_some() => {
                let known = &field.whole;
                quote!(sample.#name = crate::sample::checks::whole(#word, &ros.#wire_name, #known)?;)
            }
            Kind::Text => quote!(sample.#name = crate::Text::new(&ros.#wire_name);),
            Kind::Identity => {
                quote!(sample.#name = crate::sample::identity::read(#word, &ros.#wire_name)?;)
            }
            Kind::Named => {
                quote!(sample.#name = crate::sample::Named::from_wire(#word, &ros.#wire_name)?;)
            }
            Kind::Stamp | Kind::Float | Kind::Integer => quote!(sample.#name = ros.#wire_name;),
        }
    });
    quote!(#count #(#read)*)
}

fn check(declaration: &Declaration) -> TokenStream {
    let lists = declaration.first_list().map(|first| {
        let (field, room) = (first.wire_name.to_string(), first.kind.list());
        quote!(crate::sample::lists::fits(#field, self.count as usize, #room)?;)
    });
    let checks = declaration.on_wire().map(|field| {
        let name = &field.name;
        let word = field.wire_name.to_string();
        match &field.kind {
            Kind::Float => {
                let (or_nan, or_infinite) = (field.or_nan, field.or_infinite);
                quote!(crate::sample::checks::number(#word, self.#name, #or_nan, #or_infinite)?;)
            }
            Kind::Floats(_) => {
                quote!(crate::sample::checks::finite(#word, &self.#name[..self.len()])?;)
            }
            Kind::Flag => quote!(crate::sample::checks::flag(#word, self.#name)?;),
            Kind::Named => quote!(crate::sample::Named::check(self.#name, #word)?;),
            Kind::Text if field.whole.is_some() => {
                let known = &field.whole;
                quote!(crate::sample::checks::not_empty(#word, self.#name, #known)?;)
            }
            Kind::Text | Kind::Texts(_) | Kind::Identity | Kind::Integer | Kind::Stamp => quote!(),
        }
    });
    let together = declaration.check.iter();
    quote! {
        crate::sample::checks::stamp(self.stamp)?;
        #lists
        #(#checks)*
        #(#together(self)?;)*
    }
}

/// What every part of the sample may hold, in the order of the wire.
fn rules(declaration: &Declaration) -> Vec<TokenStream> {
    let sample = &declaration.name;
    let entry = |name: &Ident, wire_name: &Ident, size: TokenStream, rule: TokenStream| {
        let word = wire_name.to_string();
        quote! {
            crate::sample::Field {
                name: #word,
                offset: std::mem::offset_of!(#sample, #name),
                size: #size,
                rule: crate::sample::Rule::#rule,
            }
        }
    };
    let rule = |field: &Field| {
        let r#type = &field.r#type;
        let (or_nan, or_infinite) = (field.or_nan, field.or_infinite);
        let whole = field.whole.is_some();
        let rule = match &field.kind {
            _ if field.local => quote!(Local),
            Kind::Stamp => quote!(Stamp),
            Kind::Float => quote!(Number { or_nan: #or_nan, or_infinite: #or_infinite }),
            Kind::Integer | Kind::Identity => quote!(Anything),
            Kind::Flag => quote!(Flag),
            Kind::Text => quote!(Text { whole: #whole }),
            Kind::Floats(_) => quote!(Numbers),
            Kind::Texts(room) => quote!(Texts { room: #room }),
            Kind::Named => quote!(Codes(<#r#type as crate::sample::Named>::CODES)),
        };
        entry(
            &field.name,
            &field.wire_name,
            quote!(size_of::<#r#type>()),
            rule,
        )
    };
    let mut rules: Vec<TokenStream> = declaration.fields.iter().map(rule).collect();
    if let Some(first) = declaration.first_list() {
        let room = first.kind.list();
        let (name, rule) = (format_ident!("count"), quote!(Count { room: #room }));
        rules.push(entry(
            &name,
            &first.wire_name,
            quote!(size_of::<u32>()),
            rule,
        ));
    }
    let left = declaration.reserved();
    if left > 0 {
        let name = format_ident!("reserved");
        rules.push(entry(&name, &name, quote!(#left), quote!(Local)));
    }
    rules
}
