import { type ComponentType, lazy, Suspense } from "react";

/** A development server sends the library's one sheet as a whole. */
const restStyles = async () => {
  if (import.meta.env.PROD) await import("../restStyles");
};

/** A page, or a part of one, whose script and style are fetched when it is shown for the first time. */
export function lazily<Props extends object>(load: () => Promise<ComponentType<Props>>): ComponentType<Props> {
  const loadStyled = async () => {
    const styled = restStyles(); // first: where a sheet of ours says otherwise, it has to come behind
    const component = await load();
    await styled;
    return { default: component };
  };
  return lazy(loadStyled) as unknown as ComponentType<Props>;
}

/** The same for a part that a first visit does not show: until it is there, nothing is in its place. */
export function later<Props extends object>(load: () => Promise<ComponentType<Props>>): ComponentType<Props> {
  const Part = lazily(load);
  return function Later(props: Props) {
    return (
      <Suspense fallback={null}>
        <Part {...props} />
      </Suspense>
    );
  };
}
