import { Alert, Text } from "@mantine/core";

/** Instead of the picture, where it cannot be. */
export function NoWebGl() {
  return (
    <Alert color="gray" p="sm" role="status" title="This browser cannot draw 3D">
      <Text size="sm">
        WebGL is missing or switched off. The numbers need none: for the picture, switch hardware acceleration on in the
        browser's settings.
      </Text>
    </Alert>
  );
}
