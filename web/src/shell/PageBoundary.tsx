import { Alert, Button, Stack, Text } from "@mantine/core";
import { IconAlertTriangle } from "@tabler/icons-react";
import { Component, type PropsWithChildren } from "react";
import { NotLoaded } from "../lib/later";
import { NotLoadedNote } from "./NotLoadedNote";

interface State {
  error: Error | null;
}

/** A page that fails fails alone: the shell around it, with the stop button, stays. Give it a key per page. */
export class PageBoundary extends Component<PropsWithChildren, State> {
  override state: State = { error: null };

  static getDerivedStateFromError(error: Error): State {
    return { error };
  }

  override render() {
    const { error } = this.state;
    if (error === null) return this.props.children;
    if (error instanceof NotLoaded) return <NotLoadedNote why={error.message} />;
    return (
      <Alert color="red" role="alert" icon={<IconAlertTriangle size={18} aria-hidden />} title="This page has failed">
        <Stack gap="xs" align="flex-start">
          <Text size="sm">
            Motors go on as they were: stop them with the button above or Escape. Other pages still work.
          </Text>
          <pre className="m-0 box pad-s text-12 scroll">{error.message}</pre>
          <Button variant="default" onClick={() => this.setState({ error: null })}>
            Try again
          </Button>
        </Stack>
      </Alert>
    );
  }
}
