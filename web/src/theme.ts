import { createTheme, type MantineColorsTuple } from "@mantine/core";
import { FAMILY } from "./font";

/** The one accent. Red is kept for stop and faults alone. */
const accent: MantineColorsTuple = [
  "#e3f8fb",
  "#cdeef3",
  "#9cdde7",
  "#67cbda",
  "#3fbccf",
  "#26b2c8",
  "#0c8094",
  "#0b7285",
  "#086070",
  "#044b58",
];

/** Mantine's red, its filled shades darker: white on them has to be read at a glance. */
const red: MantineColorsTuple = [
  "#fff5f5",
  "#ffe3e3",
  "#ffc9c9",
  "#ffa8a8",
  "#ff8787",
  "#ff6b6b",
  "#d92d2d",
  "#d02828",
  "#c02525",
  "#a82020",
];

/** What is small where nobody says otherwise: a bench wants much in sight. */
const SMALL = { defaultProps: { size: "xs" } };

export const theme = createTheme({
  primaryColor: "accent",
  primaryShade: { light: 7, dark: 6 },
  colors: { accent, red },
  defaultRadius: "sm",
  fontFamily: FAMILY,
  fontFamilyMonospace: 'ui-monospace, "SF Mono", "Cascadia Mono", "Roboto Mono", Menlo, Consolas, monospace',
  headings: {
    fontWeight: "600",
    sizes: { h1: { fontSize: "1.25rem" }, h2: { fontSize: "1rem" }, h3: { fontSize: "0.9rem" } },
  },
  spacing: { xs: "0.375rem", sm: "0.5rem", md: "0.75rem", lg: "1rem", xl: "1.5rem" },
  cursorType: "pointer",
  components: {
    Table: { classNames: { th: "hint regular" } },
    // within words nothing but its colour would tell it from them
    Anchor: { defaultProps: { underline: "always" } },
    Autocomplete: SMALL,
    Button: SMALL,
    Checkbox: SMALL,
    MultiSelect: SMALL,
    NativeSelect: SMALL,
    NumberInput: SMALL,
    Radio: SMALL,
    SegmentedControl: SMALL,
    Switch: SMALL,
    TextInput: SMALL,
    Select: { defaultProps: { size: "xs", allowDeselect: false } },
    ActionIcon: { defaultProps: { variant: "subtle", color: "gray" } },
    Alert: { defaultProps: { variant: "light" } },
    Slider: { defaultProps: { size: 4, thumbSize: 14, label: null } },
  },
});
