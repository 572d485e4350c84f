import { Text } from "@mantine/core";

interface Props {
  /** sentences, each of its own */
  texts: readonly string[];
}

/** What does not fit, as a list that is read out when it changes. */
export function WarningList({
  texts,
  className = "list",
  ...rest
}: Props & { className?: string; "data-testid"?: string }) {
  return (
    <ul className={className} aria-live="polite" {...rest}>
      {texts.map((text) => (
        <li key={text} className="m-0 caution text-12">
          {text}
        </li>
      ))}
    </ul>
  );
}

/** What does not fit, a line each, between other lines. */
export function WarningLines({ texts }: Props) {
  return texts.map((text) => (
    <Text key={text} className="caution text-12" role="status">
      {text}
    </Text>
  ));
}
