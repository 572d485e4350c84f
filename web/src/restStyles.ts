// What `dealOutStyles` in vite.config.ts leaves out of the first sheet: fetched behind the first page.
import "@mantine/core/styles.layer.css?rest";
