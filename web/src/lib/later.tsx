import { Button, Group, Text } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { Component, type ComponentType, lazy, type PropsWithChildren, Suspense } from "react";

/** A development server sends the library's one sheet as a whole. */
const restStyles = async () => {
  if (import.meta.env.PROD) await import("../restStyles");
};

/** A script or a sheet that a page or a part is made of was not to be had. Only loading the page anew asks for it again. */
export class NotLoaded extends Error {}

/**
 * A page, or a part of one, whose script and style are fetched when it is shown for the first time. `styled`: with what the
 * first page has no style for.
 */
export function lazily<Props extends object>(
  load: () => Promise<ComponentType<Props>>,
  styled = true,
): ComponentType<Props> {
  const loadStyled = async () => {
    try {
      const styles = styled && restStyles(); // first: where a sheet of ours says otherwise, it has to come behind
      const [component] = await Promise.all([load(), styles]);
      return { default: component };
    } catch (error) {
      throw new NotLoaded(error instanceof Error ? error.message : String(error));
    }
  };
  return lazy(loadStyled) as unknown as ComponentType<Props>;
}

/**
 * The same for a part that a first visit does not show: until it is there, nothing is to be seen in its place. Where it fails the
 * page around it stays, and a message says so.
 */
export function later<Props extends object>(
  load: () => Promise<ComponentType<Props>>,
  styled = true,
): ComponentType<Props> {
  const Part = lazily(load, styled);
  return function Later(props: Props) {
    return (
      <PartBoundary>
        <Suspense fallback={<i hidden aria-busy />}>
          <Part {...props} />
        </Suspense>
      </PartBoundary>
    );
  };
}

const TOAST = "part-failed";

class PartBoundary extends Component<PropsWithChildren, { failed: boolean }> {
  override state = { failed: false };

  static getDerivedStateFromError() {
    return { failed: true };
  }

  override componentDidCatch(error: Error) {
    notifications.hide(TOAST);
    notifications.show({
      id: TOAST,
      color: "red",
      title: error instanceof NotLoaded ? "A part of this page could not be loaded" : "A part of this page has failed",
      message: (
        <Group gap="xs" mt={4}>
          <Text size="sm">
            {error instanceof NotLoaded ? "The server did not answer. The rest of the page works." : error.message}
          </Text>
          <Button size="compact-sm" onClick={() => window.location.reload()}>
            Reload the page
          </Button>
        </Group>
      ),
      autoClose: false,
    });
  }

  override render() {
    return this.state.failed ? null : this.props.children;
  }
}
